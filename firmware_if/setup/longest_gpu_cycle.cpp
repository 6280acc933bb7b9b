// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/longest_gpu_cycle.hpp"

#include <algorithm>

#include "core/worst_case/worst_case_batch.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kMoreRowsMax = 16;

/// A stage's lists as those of a batch. Its pairs of nodes lie on all levels together, the batch's
/// on each: a batch of these comes to no less. Nor does one with more rows, where a batch that
/// fills the other lists takes them.
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

}  // namespace

WorstCaseCycle longest_gpu_cycle(const Capacities& capacities, const CycleDemand& demand,
                                 std::uint32_t tree_levels) {
    WorstCaseCycle cycle;
    cycle.tree_levels = tree_levels;
    const auto add = [&](const WorkLists* lists, std::uint32_t queries, std::uint32_t times) {
        constexpr std::uint32_t kMost = CudaOptions{}.queries_max;
        const std::uint32_t launches = (queries + kMost - 1) / kMost;
        const std::uint32_t most = std::min(queries, kMost);
        if (times == 0) {
            return;
        }
        cycle.calls.push_back(
            {.capacities = lists != nullptr ? capacities_of(capacities, *lists, most, tree_levels)
                                            : capacities,
             .queries = most,
             .is_stage = lists != nullptr,
             .times = times * launches});
    };
    if (!demand.plan) {
        add(nullptr, demand.queries, 1);
        return cycle;
    }
    const CyclePlan& plan = *demand.plan;
    for (std::uint32_t stage = 0; stage < plan.stages; ++stage) {
        add(&plan.lists[stage], (stage == 0 ? demand.tasks : plan.queries[stage]) + 2, 1);
    }
    // Each is a stage of its own, with what any of them may use.
    const WorkLists jog = longest_lists(plan);
    add(&jog, demand.queries, demand.calls - plan.stages);
    return cycle;
}

}  // namespace axg
