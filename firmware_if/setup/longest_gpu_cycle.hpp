// SPDX-License-Identifier: Apache-2.0
// The longest cycle that a machine may ask of an engine on a GPU, as calls to be constructed and
// measured: every stage of the plan full, one behind the other, and the calls of a jog; in contact
// mode one batch. Source: docs/guide/gpu.md, "The longest cycle".
#pragma once

#include <cstdint>

#include "core/machine/machine.hpp"
#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/setup/choose_engine.hpp"

namespace axg {

/// @param tree_levels  CudaEngine::tree_levels() of the machine's engine
/// @return             `count` is left as it is
[[nodiscard]] WorstCaseCycle longest_gpu_cycle(const Capacities& capacities,
                                               const CycleDemand& demand,
                                               std::uint32_t tree_levels);

}  // namespace axg
