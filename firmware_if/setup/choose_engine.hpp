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

/// An engine whose first stages another engine runs on the host.
[[nodiscard]] Engine with_host(Engine gpu, CpuEngine& cpu, std::uint32_t stages) noexcept;

/// Why nothing may run.
enum class EngineRefusal : std::uint8_t { none, no_gpu, unfit };

struct ChosenEngine {
    std::optional<CudaEngine> gpu{};  // empty: the CPU engine runs all
    std::uint32_t host_stages = 0;    // first stages of a plan that the CPU engine runs
    std::string words{};              // what was measured and chosen, or why nothing may run
    double longest_us = 0;            // time of the longest cycle with the GPU; 0: not measured
    double proof_launches_us = 0;     // and its launches, where no jog begins
    EngineRefusal refusal = EngineRefusal::none;

    [[nodiscard]] std::string gpu_name() const { return gpu ? name_of(gpu->device()) : ""; }
    [[nodiscard]] Engine engine(CpuEngine& cpu) {
        return gpu ? with_host(gpu->engine(), cpu, host_stages) : cpu.engine();
    }
};

/// Upper bound of what a cycle queries on a GPU. Without a plan a call may fill all lists of the
/// engine.
struct CycleDemand {
    std::optional<CyclePlan> plan{};  // stoppable: each stage fills the lists that it has there
    std::uint32_t tasks = 0;          // pairs, each with one tool
    bool asks_twice = false;          // stage 1 also queries a longer permit
    bool has_jogs = false;
    std::uint32_t host_stages = 0;  // stages that are not the GPU's
    bool poses_parts = false;       // the GPU poses the parts of all open boxes
    TimeLimits times{};
};
[[nodiscard]] CycleDemand cycle_demand(const Machine& machine, bool is_stoppable) noexcept;

/// The longest cycle of a machine with an engine on a GPU, as it was measured.
struct MeasuredGpuCycle {
    CudaDevice device;
    std::uint32_t launches = 0, host_stages = 0;
    double launches_us = 0, proof_launches_us = 0;  // the latter where no jog begins
    double host_us = 0;                             // the host's stages, posing, rays

    [[nodiscard]] double us() const noexcept { return launches_us + host_us; }
};
/// The host runs the first stages that have few queries, or fewer of them if the longest cycle
/// does not fit into the deadline. Empty, with `fault` set: as measure_worst_case.
[[nodiscard]] std::optional<MeasuredGpuCycle> measure_gpu_cycle(const LoadedMachine& loaded,
                                                                const CycleDemand& demand,
                                                                std::uint32_t tree_levels,
                                                                std::uint32_t multiprocessors,
                                                                std::string& fault);

/// cuda: the engine on a GPU, or a refusal. automatic: that engine if it is there, may run, and
/// queries the checked pairs faster than `cpu` does, at positions spread over the travel.
/// Needs some seconds with a GPU; without one, automatic prints nothing.
/// @param multiprocessors  as make_gpu_engine: the measurement runs on that partition, too
[[nodiscard]] ChosenEngine choose_engine(const LoadedMachine& loaded, CpuEngine& cpu,
                                         EngineChoice wanted, const CycleDemand& demand,
                                         std::uint32_t multiprocessors = 0);

/// The same; where only a GPU will do, its longest cycle does not fit and the machine file pins no
/// plan, with shorter lists, step by step (plan_at).
/// @param demand  in: as cycle_demand; out: of the plan that was judged last
[[nodiscard]] ChosenEngine choose_engine_and_plan(const LoadedMachine& loaded, CpuEngine& cpu,
                                                  EngineChoice wanted, CycleDemand& demand,
                                                  std::uint32_t multiprocessors = 0);

/// choose_engine for an option's word; prints measurement and choice on stderr.
[[nodiscard]] ChosenEngine choose_and_report(const LoadedMachine& loaded, CpuEngine& cpu,
                                             const std::string& word, const CycleDemand& demand,
                                             std::uint32_t multiprocessors = 0);

/// Whether the GPU failed during the run; prints the reason on stderr.
[[nodiscard]] bool report_if_gave_up(const ChosenEngine& chosen);

/// "cpu", "cuda" or "auto"; an empty word is the machine file's choice.
[[nodiscard]] EngineChoice engine_choice(const std::string& word, const Machine& machine);

}  // namespace axg
