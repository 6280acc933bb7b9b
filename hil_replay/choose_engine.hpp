// SPDX-License-Identifier: Apache-2.0
// Which engine a guard asks, and whether it may: an engine on a GPU is used only where its longest
// batch, measured on the device at hand, fits into the deadline.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/cpu_engine.hpp"
#include "core/machine.hpp"
#include "cuda/cuda_engine.hpp"
#include "hil_replay/machine_options.hpp"

namespace axg {

struct ChosenEngine {
    std::optional<CudaEngine> gpu{};  // empty: the CPU engine answers
    std::string words{};              // what was measured and chosen, or why nothing may run
    int exit_code = 0;                // kExitGpu, kExitUnfit: nothing may run

    [[nodiscard]] std::string gpu_name() const { return gpu ? gpu->device().name : ""; }
    [[nodiscard]] Engine engine(CpuEngine& cpu) { return gpu ? gpu->engine() : cpu.engine(); }
};

/// How much of a cycle's deadline the longest batch may take; the rest is for the picture, the plan
/// and the frames (tens of microseconds: docs/measurements/replay-speed.md).
inline constexpr double kEngineShare = 0.9;

/// cuda: the engine on a GPU, or an exit code. automatic: that engine if it is there, may run, and
/// answers the checked pairs faster than `cpu` does, at positions spread over the travel.
/// Takes about two seconds where there is a GPU; where there is none, automatic says nothing.
[[nodiscard]] ChosenEngine choose_engine(const LoadedMachine& loaded, CpuEngine& cpu,
                                         EngineChoice wanted, std::int64_t deadline_us);

/// "cpu", "cuda" or "auto"; an empty word is the machine file's choice.
[[nodiscard]] EngineChoice engine_choice(const std::string& word, const Machine& machine);

}  // namespace axg
