// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench --offline: queries a second of batches without a limit on a GPU, and where the
// time goes: bus, poses, kernel, the host's part. Compares the results with those of the CPU
// engine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cuda/offline/offline_engine.hpp"
#include "firmware_if/cli/json_output.hpp"

namespace axg {

struct OfflineBenchmarkOptions {
    std::string machine;
    std::uint32_t positions = 131'072;  // spread over the travel; all pairs at each
    std::uint32_t passes = 5;
    double margin_mm = 0;  // more than the pairs' own
    JsonOutput json;
};

/// One size of batch, and one number of batches under way.
struct OfflineLine {
    std::uint32_t queries = 0, batches = 0;
    bool is_posed = false;        // by the device; otherwise the host's poses go over the bus
    double queries_s = 0;         // whole calls, with the host's checks: median of the passes
    double device_queries_s = 0;  // bus, poses and answers, without the host's part
    // Of one batch alone, from call to results; 0 where others are under way.
    double p50_us = 0, p99_us = 0;
    OfflineWork work;  // of all passes
};

struct OfflineMeasurement {
    CudaDevice device;
    CudaMemoryPlan memory;
    std::size_t queries = 0, far = 0, differ = 0;
    std::uint64_t again = 0;
    double cpu_queries_s = 0;    // one core, CPU engine
    double cpu_pose_s = 0;       // poses a second that one core makes
    double cycle_queries_s = 0;  // the cycle's engine on this GPU, in launches of 544
    std::vector<OfflineLine> lines;
};

/// Measures, prints and writes the document. Returns the program's exit code.
[[nodiscard]] int run_offline_benchmark(const OfflineBenchmarkOptions& options);

}  // namespace axg
