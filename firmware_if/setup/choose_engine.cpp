// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/choose_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "core/certificate/pair_queries.hpp"
#include "core/machine/cycle_plan.hpp"
#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/longest_gpu_cycle.hpp"
#include "firmware_if/setup/travel_sample.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kWorstCaseCycles = 150;  // of each layout
constexpr std::uint32_t kPositions = 64, kPasses = 3;

/// The slowest position's time for all checked pairs as one batch, each the least of some passes.
double slowest_us(const Machine& machine, const Engine& engine) {
    using Clock = std::chrono::steady_clock;
    const auto pair_queries = std::make_unique<PairQueries>();
    std::vector<QueryResult> results(kQueriesMax);
    double slowest = 0;
    for (std::uint32_t position = 0; position < kPositions; ++position) {
        make_contact_queries(machine, sampled_position(machine, position), *pair_queries);
        const std::uint32_t count =
            pair_queries->status == SnapshotStatus::ok ? pair_queries->count + 2 : 0;
        double least = 1e9;
        for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
            const Clock::time_point start = Clock::now();
            engine({pair_queries->queries.data(), count}, {results.data(), count});
            const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
            least = std::min(least, spent.count());
        }
        slowest = std::max(slowest, least);
    }
    return slowest;
}

/// A core runs a stage of so few queries faster than a launch does
/// (docs/measurements/gpu-fill.txt).
constexpr std::uint32_t kHostQueriesMax = 64;

/// Number of first stages with at most that many queries; the last stage is the GPU's.
std::uint32_t host_stages_max(const CycleDemand& demand) {
    std::uint32_t stages = 0;
    while (demand.plan && stages + 1 < demand.plan->stages &&
           (stages == 0 ? (demand.asks_twice ? 2 : 1) * demand.tasks
                        : demand.plan->queries[stages]) <= kHostQueriesMax) {
        ++stages;
    }
    return stages;
}

/// Parts of the longest cycle, as text.
std::string parts_of(const MeasuredGpuCycle& longest) {
    std::string launches =
        fmt::format("{} {}", longest.launches, longest.launches == 1 ? "launch" : "launches");
    if (longest.host_us == 0) {
        return launches;
    }
    const std::string stages = longest.host_stages == 0
                                   ? ""
                                   : fmt::format(" with {} {}", longest.host_stages,
                                                 longest.host_stages == 1 ? "stage" : "stages");
    return fmt::format("{} {:.0f} us, host{} {:.0f} us", launches, longest.launches_us, stages,
                       longest.host_us);
}

/// Whether the longest cycle fits into the deadline. `words`: both times, and what to change.
bool is_admitted(const LoadedMachine& loaded, const CudaEngine& gpu, const CycleDemand& demand,
                 std::uint32_t multiprocessors, ChosenEngine& out) {
    const std::optional<MeasuredGpuCycle> measured =
        measure_gpu_cycle(loaded, demand, gpu.tree_levels(), multiprocessors, out.words);
    if (!measured) {
        out.refusal = EngineRefusal::unfit;
        return false;
    }
    out.longest_us = measured->us();
    out.proof_launches_us = measured->proof_launches_us;
    out.host_stages = measured->host_stages;
    out.words = fmt::format("{}: longest cycle ({}) {:.0f} us, limit {:.0f} us (deadline {} us)",
                            name_of(measured->device), parts_of(*measured), out.longest_us,
                            demand.times.engine_us, demand.times.deadline_us);
    if (out.longest_us <= demand.times.engine_us) {
        return true;
    }
    out.words += fmt::format(". Shorten the lists in {}, raise deadline_us, or use --engine cpu",
                             demand.plan ? "cycle.lists" : "capacities.batch");
    out.refusal = EngineRefusal::unfit;
    return false;
}

/// Whether an engine on a GPU poses every box that may be open: one launch runs a later stage or a
/// round, pairs and joints fit its limits, and no box is a piece of a look-ahead path.
bool poses_parts(const Machine& machine, const CyclePlan& plan, std::uint32_t tasks) {
    bool fits = machine.can.look_ahead_samples == 0 && plan.form == TreeForm::leaves &&
                lists_of(plan).rechecks == 0 && tasks <= kQueryTreesMax;
    for (std::uint32_t stage = 1; stage < plan.stages; ++stage) {
        fits = fits && plan.queries[stage] + 2 <= CudaOptions{}.queries_max;
    }
    for (const Pair& pair : machine.pairs) {
        fits = fits && path_between(machine, pair.a, pair.b).count <= kTreeJointsMax;
    }
    return fits;
}

}  // namespace

Engine with_host(Engine gpu, CpuEngine& cpu, std::uint32_t stages) noexcept {
    const Engine host = cpu.engine();
    gpu.host = {stages, host.self, host.run_groups};
    return gpu;
}

std::optional<MeasuredGpuCycle> measure_gpu_cycle(const LoadedMachine& loaded,
                                                  const CycleDemand& demand,
                                                  std::uint32_t tree_levels,
                                                  std::uint32_t multiprocessors,
                                                  std::string& fault) {
    CudaOptions options;
    options.multiprocessors = multiprocessors;
    const auto measure = [&](const WorstCaseCycle& cycle, std::uint32_t host_stages,
                             double host_us) -> std::optional<MeasuredGpuCycle> {
        const auto launches = measure_slowest(options, {cycle}, kWorstCaseCycles, fault);
        if (!launches) {
            return std::nullopt;
        }
        return MeasuredGpuCycle{.device = launches->device,
                                .launches = launches_of(cycle),
                                .host_stages = host_stages,
                                .launches_us = launches->us_max,
                                .proof_launches_us = launches->us_max,
                                .host_us = host_us};
    };
    std::optional<MeasuredGpuCycle> proof;
    std::optional<double> host_us;
    CycleDemand here = demand;
    for (std::uint32_t left = host_stages_max(demand) + 1; left-- > 0;) {
        here.host_stages = left;
        host_us = host_share_us(loaded, here, fault);
        proof =
            host_us
                ? measure(longest_gpu_cycles(loaded.machine.capacities, here, tree_levels).front(),
                          left, *host_us)
                : std::nullopt;
        if (proof && proof->us() <= demand.times.engine_us) {
            break;
        }
    }
    // A cycle that begins a jog proves no certificate: the GPU runs all of its calls.
    const bool is_measured = here.host_stages == 0;
    here.host_stages = 0;
    const std::vector<WorstCaseCycle> all =
        longest_gpu_cycles(loaded.machine.capacities, here, tree_levels);
    if (!proof || all.size() == 1) {
        return proof;
    }
    host_us = is_measured ? host_us : host_share_us(loaded, here, fault);
    std::optional<MeasuredGpuCycle> jog =
        host_us ? measure(all[1], proof->host_stages, *host_us) : std::nullopt;
    if (jog) {
        jog->proof_launches_us = proof->launches_us;
    }
    return !jog || jog->us() > proof->us() ? jog : proof;
}

std::string name_of(const CudaDevice& device) {
    return device.multiprocessors_used == device.multiprocessors
               ? device.name
               : fmt::format("{}, {} of {} multiprocessors", device.name,
                             device.multiprocessors_used, device.multiprocessors);
}

EngineChoice engine_choice(const std::string& word, const Machine& machine) {
    if (word.empty()) {
        return machine.engine;
    }
    return word == "cpu"    ? EngineChoice::cpu
           : word == "cuda" ? EngineChoice::cuda
                            : EngineChoice::automatic;
}

CycleDemand cycle_demand(const Machine& machine, bool is_stoppable) noexcept {
    const TimeLimits times = time_limits(machine);
    if (!is_stoppable) {
        return {.times = times};
    }
    const std::uint32_t tasks = stop_tasks(machine);
    const CyclePlan plan = cycle_plan(machine, tasks);
    return {.plan = plan,
            .tasks = tasks,
            .asks_twice = tries_longer(machine.can.permit_samples),
            .has_jogs = machine.guard.jog.is_promised,
            .poses_parts = poses_parts(machine, plan, tasks),
            .times = times};
}

ChosenEngine choose_engine(const LoadedMachine& loaded, CpuEngine& cpu, EngineChoice wanted,
                           const CycleDemand& demand, std::uint32_t multiprocessors) {
    ChosenEngine out;
    if (wanted == EngineChoice::cpu) {
        return out;
    }
    if (std::optional<CudaEngine> made = make_gpu_engine(loaded, out.words, multiprocessors)) {
        out.gpu.emplace(std::move(*made));
    } else {
        const bool is_wanted = wanted == EngineChoice::cuda;
        return {.words = is_wanted ? out.words : "",
                .refusal = is_wanted ? EngineRefusal::no_gpu : EngineRefusal::none};
    }
    if (!is_admitted(loaded, *out.gpu, demand, multiprocessors, out)) {
        out.gpu.reset();
    }
    if (wanted == EngineChoice::cuda) {
        return out;
    }
    out.refusal = EngineRefusal::none;
    if (!out.gpu) {
        out.words = "engine auto: CPU; " + out.words;
        return out;
    }
    const double gpu_us = slowest_us(loaded.machine, out.gpu->engine());
    const double cpu_us = slowest_us(loaded.machine, cpu.engine());
    const bool takes_gpu = out.gpu->fault() == nullptr && gpu_us < cpu_us;
    out.words =
        fmt::format("engine auto: {}; slowest of {} positions: CPU {:.1f} us, GPU {:.1f} us; {}",
                    takes_gpu ? "GPU" : "CPU", kPositions, cpu_us, gpu_us, out.words);
    if (!takes_gpu) {
        out.gpu.reset();
    }
    return out;
}

ChosenEngine choose_engine_and_plan(const LoadedMachine& loaded, CpuEngine& cpu,
                                    EngineChoice wanted, CycleDemand& demand,
                                    std::uint32_t multiprocessors) {
    const Machine& machine = loaded.machine;
    std::optional<ChosenEngine> chosen(choose_engine(loaded, cpu, wanted, demand, multiprocessors));
    const bool may_shorten = demand.plan && !machine.cycle.is_pinned && !machine.plan;
    for (std::uint32_t step = kPlanStepAsStated;
         may_shorten && step > 0 && chosen->refusal == EngineRefusal::unfit; --step) {
        demand.plan = plan_at(machine, demand.tasks, step - 1);
        chosen.emplace(choose_engine(loaded, cpu, wanted, demand, multiprocessors));
        chosen->words += "; cycle plan: " + format_plan(*demand.plan);
    }
    return std::move(*chosen);
}

ChosenEngine choose_and_report(const LoadedMachine& loaded, CpuEngine& cpu, const std::string& word,
                               const CycleDemand& demand, std::uint32_t multiprocessors) {
    ChosenEngine chosen =
        choose_engine(loaded, cpu, engine_choice(word, loaded.machine), demand, multiprocessors);
    if (!chosen.words.empty()) {
        fmt::print(stderr, "axguard: {}\n", chosen.words);
    }
    return chosen;
}

bool report_if_gave_up(const ChosenEngine& chosen) {
    const char* const fault = chosen.gpu ? chosen.gpu->fault() : nullptr;
    if (fault != nullptr) {
        fmt::print(stderr, "axguard: GPU failed: {}\n", fault);
    }
    return fault != nullptr;
}

}  // namespace axg
