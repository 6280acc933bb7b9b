// SPDX-License-Identifier: Apache-2.0
// Measures the time of the longest cycle of a machine on the present device, call by call: the
// worst-case batch (core/worst_case/worst_case_batch.hpp) with warm caches, with cold caches, and
// during copies that use memory and bus. Microseconds, from launch to last result. This header has
// no CUDA types.
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
    Capacities capacities{};      // capacities.batch: the lists of the call
    std::uint32_t queries = 512;  // in one launch: at most CudaOptions::queries_max
    bool is_stage = false;        // the queries are in a group, whose work is charged
    // Float-only parts of at most this many boxes and tasks, posed by the engine; 0: by the host.
    std::uint32_t roots_max = 0, trees_max = 0;
    std::uint32_t times = 1;  // runs in sequence
};

/// The calls of the longest cycle, and how often to measure it.
struct WorstCaseCycle {
    std::uint32_t tree_levels = 2;     // CudaEngine::tree_levels() of the machine's engine
    std::vector<WorstCaseCall> calls;  // in sequence, on one engine
    std::uint32_t count = 150;         // cycles of each layout, a third under each condition
};

/// A cycle of `launches` batches that fill a machine's lists.
[[nodiscard]] WorstCaseCycle batch_cycle(const Capacities& capacities, std::uint32_t launches = 1);
[[nodiscard]] std::uint32_t launches_of(const WorstCaseCycle& cycle) noexcept;

struct WorstCaseMeasurement {
    struct Line {
        // Layout of each call's work; "slowest": each call has the layout with its longest time.
        std::string layout, condition;
        std::vector<double> cycle_us;  // in the order they were measured
    };
    CudaDevice device;
    WorstCaseCycle cycle;
    std::vector<Line> lines;
    double us_max = 0;  // of all lines
};

/// Measures with an engine of its own and destroys it. Returns nothing and sets `fault` without a
/// device, if the capacities cannot be filled, or if a batch did not do the work planned for it.
/// Precondition: at least one call; all calls are stages, or none.
[[nodiscard]] std::optional<WorstCaseMeasurement> measure_worst_case(const CudaOptions& options,
                                                                     const WorstCaseCycle& cycle,
                                                                     std::string& fault);

}  // namespace axg
