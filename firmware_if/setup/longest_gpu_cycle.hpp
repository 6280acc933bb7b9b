// SPDX-License-Identifier: Apache-2.0
// The longest cycles of a machine on a GPU engine, as calls to be constructed and measured: every
// stage of the plan full, one after the other, or the ladders of a cycle that begins a jog; in
// contact mode one batch. Source: docs/guide/gpu.md, "The longest cycle".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/setup/choose_engine.hpp"

namespace axg {

/// @param tree_levels  CudaEngine::tree_levels() of the machine's engine
/// @return             the proof's first; `count` is left as it is
[[nodiscard]] std::vector<WorstCaseCycle> longest_gpu_cycles(const Capacities& capacities,
                                                             const CycleDemand& demand,
                                                             std::uint32_t tree_levels);

/// Measures each cycle `count` times in each layout; returns the longest. Empty, with `fault` set:
/// as measure_worst_case.
[[nodiscard]] std::optional<WorstCaseMeasurement> measure_slowest(
    const CudaOptions& options, std::vector<WorstCaseCycle> cycles, std::uint32_t count,
    std::string& fault);

/// Host time of such a cycle without the launches, but with the host's stages (CycleDemand); 0 in
/// contact mode, where it poses each pair once. Empty, with `fault` set: as measure_host_us.
[[nodiscard]] std::optional<double> host_share_us(const LoadedMachine& loaded,
                                                  const CycleDemand& demand, std::string& fault);

}  // namespace axg
