// SPDX-License-Identifier: Apache-2.0
// Which engine a guard runs, and whether it may: an engine on a GPU is used only where its longest
// cycle, measured on the device at hand, fits into the deadline.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/collision/cpu_engine.hpp"
#include "core/guard/time_limits.hpp"
#include "core/machine/machine.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Its name; of a partition, how much of it.
[[nodiscard]] std::string name_of(const CudaDevice& device);

/// An engine whose first stages another one on the host answers.
[[nodiscard]] Engine with_host(Engine gpu, CpuEngine& cpu, std::uint32_t stages) noexcept;

/// Why nothing may run.
enum class EngineRefusal : std::uint8_t { none, no_gpu, unfit };

struct ChosenEngine {
    std::optional<CudaEngine> gpu{};  // empty: the CPU engine answers
    std::uint32_t host_stages = 0;    // of a plan: the CPU engine answers so many first ones
    std::string words{};              // what was measured and chosen, or why nothing may run
    double longest_us = 0;            // what the longest cycle took on the GPU; 0: not measured
    double proof_launches_us = 0;     // and its launches, where no jog begins
    EngineRefusal refusal = EngineRefusal::none;

    [[nodiscard]] std::string gpu_name() const { return gpu ? name_of(gpu->device()) : ""; }
    [[nodiscard]] Engine engine(CpuEngine& cpu) {
        return gpu ? with_host(gpu->engine(), cpu, host_stages) : cpu.engine();
    }
};

/// What a cycle may query on a GPU, at most. Without a plan a call may fill all lists of the
/// engine.
struct CycleDemand {
    std::optional<CyclePlan> plan{};  // stoppable: each stage fills the lists that it has there
    std::uint32_t tasks = 0;          // pairs, each with one tool
    bool asks_twice = false;          // the first stage has a query for a longer permit besides
    bool has_jogs = false;
    std::uint32_t host_stages = 0;  // stages that are not the GPU's
    bool poses_parts = false;       // an engine that poses parts of boxes is always let to
    TimeLimits times{};
};
[[nodiscard]] CycleDemand cycle_demand(const Machine& machine, bool is_stoppable) noexcept;

/// The longest cycle of a machine with an engine on a GPU, as it was measured.
struct MeasuredGpuCycle {
    CudaDevice device;
    std::uint32_t launches = 0, host_stages = 0;
    double launches_us = 0, proof_launches_us = 0;  // the latter where no jog begins
    double host_us = 0;  // what the host does besides: its stages, posing, rays

    [[nodiscard]] double us() const noexcept { return launches_us + host_us; }
};
/// The host answers as many of the first stages as have few queries, or fewer where the longest
/// cycle would not fit into the deadline. Empty, with `fault` set: as measure_worst_case.
[[nodiscard]] std::optional<MeasuredGpuCycle> measure_gpu_cycle(const LoadedMachine& loaded,
                                                                const CycleDemand& demand,
                                                                std::uint32_t tree_levels,
                                                                std::uint32_t multiprocessors,
                                                                std::string& fault);

/// cuda: the engine on a GPU, or a refusal. automatic: that engine if it is there, may run, and
/// answers the checked pairs faster than `cpu` does, at positions spread over the travel.
/// Takes some seconds with a GPU; without one, automatic prints nothing.
/// @param multiprocessors  as make_gpu_engine: what is measured runs on that partition, too
[[nodiscard]] ChosenEngine choose_engine(const LoadedMachine& loaded, CpuEngine& cpu,
                                         EngineChoice wanted, const CycleDemand& demand,
                                         std::uint32_t multiprocessors = 0);

/// The same; where only a GPU will do, its longest cycle does not fit and the machine file pins no
/// plan, with shorter lists, step by step (plan_at).
/// @param demand  in: as cycle_demand; out: of the plan that was judged last
[[nodiscard]] ChosenEngine choose_engine_and_plan(const LoadedMachine& loaded, CpuEngine& cpu,
                                                  EngineChoice wanted, CycleDemand& demand,
                                                  std::uint32_t multiprocessors = 0);

/// choose_engine for an option's word; what was measured and chosen goes to stderr.
[[nodiscard]] ChosenEngine choose_and_report(const LoadedMachine& loaded, CpuEngine& cpu,
                                             const std::string& word, const CycleDemand& demand,
                                             std::uint32_t multiprocessors = 0);

/// Whether the GPU was lost on the way; if so, why goes to stderr.
[[nodiscard]] bool report_if_gave_up(const ChosenEngine& chosen);

/// "cpu", "cuda" or "auto"; an empty word is the machine file's choice.
[[nodiscard]] EngineChoice engine_choice(const std::string& word, const Machine& machine);

}  // namespace axg
