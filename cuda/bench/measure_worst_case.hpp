// SPDX-License-Identifier: Apache-2.0
// How long the longest cycle of a machine takes on the device at hand, call for call: the
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

/// A call of the engine that fills all its lists.
struct WorstCaseCall {
    Capacities capacities{};      // with the lists of the call as those of a batch
    std::uint32_t queries = 512;  // in one launch: at most CudaOptions::queries_max
    bool is_stage = false;        // they are in a group, whose work is charged
    // And parts of so many boxes and tasks, which the engine poses, in float; 0: the host poses.
    std::uint32_t roots_max = 0, trees_max = 0;
    std::uint32_t times = 1;  // one behind the other
};

/// What a cycle may come to, and how often to measure it.
struct WorstCaseCycle {
    std::uint32_t tree_levels = 2;     // CudaEngine::tree_levels() of the machine's engine
    std::vector<WorstCaseCall> calls;  // one behind the other, on one engine
    std::uint32_t count = 150;         // cycles of each layout, a third under each condition
};

/// A cycle of `launches` batches that fill a machine's lists.
[[nodiscard]] WorstCaseCycle batch_cycle(const Capacities& capacities, std::uint32_t launches = 1);
[[nodiscard]] std::uint32_t launches_of(const WorstCaseCycle& cycle) noexcept;

struct WorstCaseMeasurement {
    struct Line {
        // Of each call's work; "slowest": of each call the layout in which it took longest.
        std::string layout, condition;
        std::vector<double> cycle_us;  // in the order they were measured
    };
    CudaDevice device;
    WorstCaseCycle cycle;
    std::vector<Line> lines;
    double us_max = 0;  // of all lines
};

/// The engine it makes for that is given back. Empty, with `fault` set: no device, capacities
/// that cannot be filled, or a batch that did not do the work it was made for.
/// Precondition: at least one call; all of stages, or none.
[[nodiscard]] std::optional<WorstCaseMeasurement> measure_worst_case(const CudaOptions& options,
                                                                     const WorstCaseCycle& cycle,
                                                                     std::string& fault);

}  // namespace axg
