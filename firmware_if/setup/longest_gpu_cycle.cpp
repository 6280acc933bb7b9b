// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/longest_gpu_cycle.hpp"

#include <algorithm>
#include <utility>

#include "core/certificate/pair_queries.hpp"
#include "core/reach/jog.hpp"
#include "core/worst_case/worst_case_batch.hpp"
#include "firmware_if/setup/measure_cycle.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kMoreRowsMax = 16;

/// Converts a stage's lists to those of a batch. A stage counts node pairs over all tree levels, a
/// batch counts them on each: the batch does no less work. Adds rows until a batch can fill the
/// other lists; that is no less work either.
Capacities capacities_of(Capacities capacities, const WorkLists& lists, std::uint32_t queries,
                         std::uint32_t tree_levels) {
    BatchCapacities& batch = capacities.batch;
    batch = {lists.node_pairs, lists.leaf_pairs, lists.box_rows, lists.triangle_pairs,
             lists.rechecks};
    WorstCaseBatch made;
    for (const WorstCaseLayout layout : {WorstCaseLayout::even, WorstCaseLayout::heaped}) {
        for (std::uint32_t i = 0; i < kMoreRowsMax; ++i) {
            if (make_worst_case_batch(capacities, queries, tree_levels, layout, made).empty()) {
                break;
            }
            batch.box_rows += batch.box_rows / 4 + 1;
        }
    }
    return capacities;
}

/// Appends calls to a cycle.
class CycleMaker {
  public:
    CycleMaker(const Capacities& capacities, std::uint32_t tree_levels) : capacities_(capacities) {
        cycle_.tree_levels = tree_levels;
    }
    /// @param roots_max, trees_max  WorstCaseCall's
    CycleMaker& stage(const WorkLists& lists, std::uint32_t queries, std::uint32_t roots_max = 0,
                      std::uint32_t trees_max = 0) {
        const std::uint32_t most = std::min(queries, kMost);
        add(capacities_of(capacities_, lists, most, cycle_.tree_levels), queries, true);
        if (queries <= kMost) {
            cycle_.calls.back().roots_max = roots_max;
            cycle_.calls.back().trees_max = trees_max;
        }
        return *this;
    }
    CycleMaker& add(const Capacities& capacities, std::uint32_t queries, bool is_stage) {
        cycle_.calls.push_back({.capacities = capacities,
                                .queries = std::min(queries, kMost),
                                .is_stage = is_stage,
                                .times = (queries + kMost - 1) / kMost});
        return *this;
    }
    [[nodiscard]] WorstCaseCycle take() { return std::move(cycle_); }

  private:
    static constexpr std::uint32_t kMost = CudaOptions{}.queries_max;
    const Capacities& capacities_;
    WorstCaseCycle cycle_;
};

constexpr std::uint32_t kKnownAnswers = 2;  // queries of the known-answer test, in every call

/// first_share_of, all groups together.
WorkLists most_of_first(const CyclePlan& plan, bool asks_twice) noexcept {
    return asks_twice && plan.stages > 1 ? plan.lists[0] + plan.lists[0] : plan.lists[0];
}

/// Adds a launch for the open boxes, and one a round; the first round has the work of all rounds.
void add_rounds(const CycleDemand& demand, CycleMaker& proof) {
    const CyclePlan& plan = *demand.plan;
    const std::uint32_t trees = demand.poses_parts ? demand.tasks : 0;
    proof.stage(lists_of_whole_boxes(plan), demand.tasks + kKnownAnswers);
    proof.stage(lists_of_rounds(plan), plan.queries[1] + kKnownAnswers, trees, trees);
    for (std::uint32_t round = 1; round < kRoundsMax; ++round) {
        proof.stage(kKnownAnswerShare, 2 + kKnownAnswers, demand.poses_parts ? 1 : 0, trees);
    }
}

}  // namespace

std::vector<WorstCaseCycle> longest_gpu_cycles(const Capacities& capacities,
                                               const CycleDemand& demand,
                                               std::uint32_t tree_levels) {
    if (!demand.plan) {
        return {CycleMaker(capacities, tree_levels).add(capacities, kQueriesMax, false).take()};
    }
    const CyclePlan& plan = *demand.plan;
    CycleMaker proof(capacities, tree_levels);
    if (demand.host_stages == 0) {
        proof.stage(most_of_first(plan, demand.asks_twice),
                    (demand.asks_twice ? 2 : 1) * demand.tasks + kKnownAnswers);
    }
    for (std::uint32_t stage = std::max(demand.host_stages, 1U); stage < plan.stages; ++stage) {
        if (asks_again(stage, plan)) {
            add_rounds(demand, proof);
            continue;
        }
        const std::uint32_t open = stage == 1 ? demand.tasks : plan.queries[stage - 1];
        proof.stage(plan.lists[stage], plan.queries[stage] + kKnownAnswers,
                    demand.poses_parts ? open : 0, demand.tasks);
    }
    std::vector<WorstCaseCycle> cycles{proof.take()};
    if (demand.has_jogs) {
        const JogLists lists = jog_lists(plan);
        const std::uint32_t ladders = std::min(demand.tasks, jog_ladders(plan));
        cycles.push_back(CycleMaker(capacities, tree_levels)
                             .stage(lists.margins, demand.tasks)
                             .stage(lists.rungs, ladders * (kJogRungs - 1))
                             .stage(kKnownAnswerShare, kKnownAnswers)
                             .take());
    }
    return cycles;
}

std::optional<WorstCaseMeasurement> measure_slowest(const CudaOptions& options,
                                                    std::vector<WorstCaseCycle> cycles,
                                                    std::uint32_t count, std::string& fault) {
    std::optional<WorstCaseMeasurement> slowest;
    for (WorstCaseCycle& cycle : cycles) {
        cycle.count = count;
        std::optional<WorstCaseMeasurement> measured = measure_worst_case(options, cycle, fault);
        if (!measured) {
            return std::nullopt;
        }
        if (!slowest || measured->us_max > slowest->us_max) {
            slowest = std::move(measured);
        }
    }
    return slowest;
}

std::optional<double> host_share_us(const LoadedMachine& loaded, const CycleDemand& demand,
                                    std::string& fault) {
    return demand.plan ? measure_host_us(loaded, *demand.plan, demand.host_stages,
                                         demand.poses_parts, fault)
                       : 0.0;
}

}  // namespace axg
