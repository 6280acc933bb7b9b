// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/choose_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "core/certificate/jog.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/machine/cycle_plan.hpp"
#include "core/worst_case/worst_case_batch.hpp"
#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/travel_sample.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kWorstCaseCycles = 150;  // of each layout
constexpr std::uint32_t kPositions = 64, kPasses = 3;
constexpr std::uint32_t kMoreRowsMax = 16;

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

/// The longest launch of a call that may fill these lists, as often as the call takes. Empty: the
/// reason is in `out`.
std::optional<double> longest_call_us(const Capacities& capacities, WorstCaseCycle cycle,
                                      const CudaOptions& options, ChosenEngine& out,
                                      std::string& device) {
    const std::uint32_t launches = (cycle.queries + options.queries_max - 1) / options.queries_max;
    cycle.count = kWorstCaseCycles;
    const std::optional<WorstCaseMeasurement> measured =
        measure_worst_case(capacities, options, cycle, out.words);
    if (!measured) {
        out.refusal = EngineRefusal::no_gpu;
        return std::nullopt;
    }
    device = name_of(measured->device);
    return launches * measured->us_max;
}

/// A stage's lists as those of a batch. Its pairs of nodes lie on all levels together, the batch's
/// on each: a batch of these comes to no less. Nor does one with more rows, where a batch that
/// fills the other lists takes them.
Capacities capacities_of(Capacities capacities, const WorkLists& lists,
                         const WorstCaseCycle& cycle) {
    BatchCapacities& batch = capacities.batch;
    batch = {lists.node_pairs, lists.leaf_pairs, lists.box_rows, lists.triangle_pairs,
             lists.rechecks};
    const std::uint32_t queries = std::min(cycle.queries, CudaOptions{}.queries_max);
    WorstCaseBatch made;
    for (const WorstCaseLayout layout : {WorstCaseLayout::even, WorstCaseLayout::heaped}) {
        for (std::uint32_t i = 0; i < kMoreRowsMax; ++i) {
            if (make_worst_case_batch(capacities, queries, cycle.tree_levels, layout, made)
                    .empty()) {
                break;
            }
            batch.box_rows += batch.box_rows / 4 + 1;
        }
    }
    return capacities;
}

/// All stages full, one behind the other, and the calls of a jog. Empty as above.
std::optional<double> longest_cycle_us(const LoadedMachine& loaded, const CycleDemand& demand,
                                       WorstCaseCycle cycle, const CudaOptions& options,
                                       ChosenEngine& out, std::string& device) {
    const Capacities& capacities = loaded.machine.capacities;
    if (!demand.plan) {
        cycle.queries = demand.queries;
        return longest_call_us(capacities, cycle, options, out, device);
    }
    const CyclePlan& plan = *demand.plan;
    cycle.is_stage = true;
    double sum = 0;
    for (std::uint32_t call = 0; call <= plan.stages; ++call) {
        const bool is_jog = call == plan.stages;
        const std::uint32_t times = is_jog ? demand.calls - plan.stages : 1;
        const WorkLists lists = is_jog ? longest_lists(plan) : plan.lists[call];
        cycle.queries = is_jog      ? demand.queries
                        : call == 0 ? demand.tasks + 2
                                    : plan.queries[call] + 2;
        if (times == 0) {
            continue;
        }
        const std::optional<double> us =
            longest_call_us(capacities_of(capacities, lists, cycle), cycle, options, out, device);
        if (!us) {
            return std::nullopt;
        }
        sum += times * *us;
    }
    return sum;
}

/// Whether the longest cycle fits into the deadline; `words` say by how much, or what to change.
bool is_admitted(const LoadedMachine& loaded, const CudaEngine& gpu, const CycleDemand& demand,
                 std::uint32_t multiprocessors, ChosenEngine& out) {
    CudaOptions options;
    options.multiprocessors = multiprocessors;
    WorstCaseCycle cycle;
    cycle.tree_levels = gpu.tree_levels();
    std::string device;
    const std::optional<double> longest_us =
        longest_cycle_us(loaded, demand, cycle, options, out, device);
    if (!longest_us) {
        return false;
    }
    out.longest_us = *longest_us;
    out.words =
        fmt::format("{}: longest cycle ({} launches) {:.0f} us, limit {:.0f} us (deadline {} us)",
                    device, demand.calls * demand.launches, out.longest_us, demand.times.engine_us,
                    demand.times.deadline_us);
    if (out.longest_us <= demand.times.engine_us) {
        return true;
    }
    out.words += fmt::format(". Shorten the lists in {}, raise deadline_us, or use --engine cpu",
                             demand.plan ? "cycle.lists" : "capacities.batch");
    out.refusal = EngineRefusal::unfit;
    return false;
}

}  // namespace

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
        return {.queries = kQueriesMax, .times = times};
    }
    const std::uint32_t tasks = stop_tasks(machine);
    const CyclePlan plan = cycle_plan(machine, tasks);
    const bool has_jogs = machine.guard.jog.is_promised;
    // A ladder is asked of so many pairs at the most.
    std::uint32_t queries = tries_longer(machine.can.permit_samples) ? 2 * tasks : tasks;
    queries = has_jogs ? std::max(queries, kJogLaddersMax * (kJogRungs - 1)) : queries;
    for (std::uint32_t stage = 1; stage < plan.stages; ++stage) {
        queries = std::max(queries, plan.queries[stage]);
    }
    queries += 2;  // the known-answer test
    constexpr std::uint32_t kMost = CudaOptions{}.queries_max;
    return {.calls = plan.stages + (has_jogs ? 2U : 0U),
            .launches = (queries + kMost - 1) / kMost,
            .queries = queries,
            .plan = plan,
            .tasks = tasks,
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
