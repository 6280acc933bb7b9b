// SPDX-License-Identifier: Apache-2.0
// How long the longest batch of a machine takes on the device at hand: the constructed worst case
// (cuda/fill_scene.hpp), with its lists in the caches, out of them, and beside another user of
// memory and bus. Microseconds, launch to last answer. No CUDA type shows here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/machine.hpp"
#include "cuda/cuda_engine.hpp"

namespace axg {

struct FillMeasurement {
    struct Line {
        std::string layout, condition;
        std::vector<double> cycle_us;  // in the order they were measured
    };
    CudaDevice device;
    std::uint32_t questions = 0, levels = 0;
    std::vector<Line> lines;
    double us_max = 0;  // of all lines
};

/// Measures `cycles` batches of each way to fill it, a third of them under each condition. The
/// engine it makes for that is given back. Empty, with `fault` set: no device, capacities that
/// cannot be filled, or a batch that did not do the work it was made for.
/// @param levels  CudaEngine::levels() of the machine's engine
[[nodiscard]] std::optional<FillMeasurement> measure_fill(const Capacities& capacities,
                                                          const CudaOptions& options,
                                                          std::uint32_t levels,
                                                          std::uint32_t cycles, std::string& fault);

}  // namespace axg
