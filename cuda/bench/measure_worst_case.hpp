// SPDX-License-Identifier: Apache-2.0
// How long the longest batch, or cycle of batches, of a machine takes on the device at hand: the
// worst-case batch (core/worst_case/worst_case_batch.hpp), with its lists in the caches, out of
// them, and beside another user of memory and bus. Microseconds, launch to last result. No CUDA
// type shows here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "cuda/engine/cuda_engine.hpp"

namespace axg {

/// What a cycle may come to, and how often to measure it.
struct WorstCaseCycle {
    std::uint32_t tree_levels = 2;  // CudaEngine::tree_levels() of the machine's engine
    std::uint32_t launches = 1;     // of a cycle, each with all lists full
    std::uint32_t queries = 512;    // of a launch
    bool is_stage = false;          // they are in a group, whose work is charged
    std::uint32_t count = 150;      // cycles of each way to fill it, a third under each condition
};

struct WorstCaseMeasurement {
    struct Line {
        std::string layout, condition;
        std::vector<double> cycle_us;  // in the order they were measured
    };
    CudaDevice device;
    WorstCaseCycle cycle;
    std::vector<Line> lines;
    double us_max = 0;  // of all lines
};

/// The engines it makes for that are given back. Empty, with `fault` set: no device, capacities
/// that cannot be filled, or a batch that did not do the work it was made for.
[[nodiscard]] std::optional<WorstCaseMeasurement> measure_worst_case(const Capacities& capacities,
                                                                     const CudaOptions& options,
                                                                     const WorstCaseCycle& cycle,
                                                                     std::string& fault);

}  // namespace axg
