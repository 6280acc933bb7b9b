// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench --worst-case: measures the worst-case batch, or the longest cycle of a plan, on
// this host's GPU, with the capacities and tree levels of a machine.
#pragma once

#include <cstdint>
#include <string>

#include "firmware_if/cli/json_output.hpp"

namespace axg {

struct WorstCaseBenchmarkOptions {
    std::string machine;            // empty: usual capacities, two tree levels of pairs of nodes
    std::uint32_t tree_levels = 0;  // of pairs of nodes; 0: the machine's
    std::uint32_t launches = 1;     // of a cycle, each with all lists full
    std::uint32_t stages = 0;       // of the machine's plan; 0: batches
    std::string axis_data = "computed";  // a name of leaf_kernels(), or all: one after the other
    std::uint32_t sms = 0, cycles = 10000;
    JsonOutput json;
};

/// Measures, prints and writes the document. Returns the program's exit code.
[[nodiscard]] int run_worst_case_benchmark(const WorstCaseBenchmarkOptions& options);

}  // namespace axg
