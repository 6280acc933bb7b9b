// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench --worst-case --engine cpu: measures the longest cycle of a machine's plan on
// this processor, with the whole chain.
#pragma once

#include <cstdint>
#include <string>

#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/setup/choose_plan.hpp"

namespace axg {

struct CycleBenchmarkOptions {
    std::string machine;
    std::string lanes;                       // avx512, avx2, neon; empty: the widest
    std::uint32_t cycles = 0;                // of all lines together; 0: five a line
    std::uint32_t step = kPlanStepAsStated;  // of the machine's plan (choose_plan.hpp)
    JsonOutput json;
};

/// Measures, prints and writes the document. Returns the program's exit code.
[[nodiscard]] int run_cycle_benchmark(const CycleBenchmarkOptions& options);

}  // namespace axg
