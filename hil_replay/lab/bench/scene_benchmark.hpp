// SPDX-License-Identifier: Apache-2.0
// Measures the time of an engine for a cycle of queries, cycle after cycle, over the poses of a
// scene folder. Stores every sample; the table prints their number N and 3/N, the bound of the miss
// rate after N cycles without a miss.
#pragma once

#include <cstdint>
#include <string>

#include "firmware_if/cli/json_output.hpp"

namespace axg {

struct SceneBenchmarkOptions {
    std::string folder;
    std::string engine = "auto", kind = "hit";
    double within_mm = 50.0, margin_mm = 0.0;
    std::uint32_t queries = 0;  // a cycle; 0: the pairs of one pose
    std::uint32_t sms = 0, cycles = 10000;
    std::string axis_data = "computed";  // of cuda: a name of leaf_kernels()
    JsonOutput json;
};

/// Measures, prints and writes the document. Returns the program's exit code.
[[nodiscard]] int run_scene_benchmark(const SceneBenchmarkOptions& options);

}  // namespace axg
