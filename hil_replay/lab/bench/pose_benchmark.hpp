// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench --pose: measures how long a cycle takes to pose its boxes, without engine and
// containment tests. Its engine returns at once and proves no box.
#pragma once

#include <cstdint>
#include <string>

#include "firmware_if/cli/json_output.hpp"

namespace axg {

struct PoseBenchmarkOptions {
    std::string machine;
    std::uint32_t passes = 25;  // reports the least time
    JsonOutput json;
};

struct PoseMeasurement {
    std::uint32_t tasks = 0;
    std::uint64_t queries = 0, batches = 0;  // of a cycle, known-answer test included
    double us = 0;                           // least of the passes
};

/// Measures, prints and writes the document. Returns the program's exit code.
[[nodiscard]] int run_pose_benchmark(const PoseBenchmarkOptions& options);

}  // namespace axg
