// SPDX-License-Identifier: Apache-2.0
// Of which calls the longest cycles on a GPU consist: each stage with its own lists full, where a
// jog begins its ladders in their place, in contact mode one batch. No GPU is needed.
#include "firmware_if/setup/longest_gpu_cycle.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/certificate/stop_certificate.hpp"
#include "core/reach/jog.hpp"
#include "core/worst_case/worst_case_batch.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kLevels = 2;

class LongestGpuCycle : public ::testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(
            load(AXG_SOURCE_DIR "/config/machines/paper-trunnion.yaml", "", loaded_, stderr));
    }
    [[nodiscard]] std::vector<WorstCaseCycle> cycles(bool is_stoppable,
                                                     std::uint32_t levels = kLevels) const {
        return longest_gpu_cycles(loaded_.machine.capacities,
                                  cycle_demand(loaded_.machine, is_stoppable), levels);
    }

    LoadedMachine loaded_;
};

/// What each call may use is no less than `lists`.
void expect_no_less(const WorstCaseCall& call, const WorkLists& lists) {
    const BatchCapacities& batch = call.capacities.batch;
    EXPECT_TRUE(call.is_stage);
    EXPECT_GE(batch.level_pairs, lists.node_pairs);
    EXPECT_GE(batch.leaf_pairs, lists.leaf_pairs);
    EXPECT_GE(batch.box_rows, lists.box_rows);
    EXPECT_GE(batch.triangle_pairs, lists.triangle_pairs);
    EXPECT_GE(batch.rechecks, lists.rechecks);
}

TEST_F(LongestGpuCycle, EveryStageIsFullOneBehindTheOther) {
    loaded_.machine.guard.jog.is_promised = false;
    loaded_.machine.can.permit_samples = {3, 3};
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        loaded_.machine.cycle.stages = stages;
        const CycleDemand demand = cycle_demand(loaded_.machine, true);
        const std::vector<WorstCaseCycle> made = cycles(true);
        ASSERT_EQ(made.size(), 1U);
        EXPECT_EQ(made[0].tree_levels, kLevels);
        const std::vector<WorstCaseCall>& calls = made[0].calls;
        ASSERT_EQ(calls.size(), stages + (stages == 3 ? kRoundsMax : 0));
        EXPECT_EQ(launches_of(made[0]), calls.size());
        for (std::uint32_t stage = 0; stage < stages; ++stage) {
            if (!asks_again(stage, *demand.plan)) {
                const WorstCaseCall& call = stage == 2 ? calls.back() : calls[stage];
                expect_no_less(call, demand.plan->lists[stage]);
                EXPECT_EQ(call.queries,
                          2 + (stage == 0 ? demand.tasks : demand.plan->queries[stage]));
            }
        }
        if (stages == 3) {
            expect_no_less(calls[1], lists_of_whole_boxes(*demand.plan));
            expect_no_less(calls[2], lists_of_rounds(*demand.plan));
            EXPECT_EQ(calls[1].queries, 2 + demand.tasks);
            EXPECT_EQ(calls[2].queries, 2 + demand.plan->queries[1]);
        }
    }
}

// What is asked of the longer permit may use as much again (first_share_of).
TEST_F(LongestGpuCycle, TheFirstStageMayAskTwice) {
    loaded_.machine.can.permit_samples = {3, 12};
    const CycleDemand demand = cycle_demand(loaded_.machine, true);
    ASSERT_TRUE(demand.asks_twice);
    const WorkLists& lists = demand.plan->lists[0];
    const WorstCaseCall first = cycles(true)[0].calls[0];
    EXPECT_EQ(first.queries, 2 * demand.tasks + 2);
    expect_no_less(first, {2 * lists.node_pairs, 2 * lists.leaf_pairs, 2 * lists.box_rows,
                           2 * lists.triangle_pairs, 2 * lists.rechecks});
}

// The snapshot where a jog begins is proven nothing of: its ladders take the stages' place.
TEST_F(LongestGpuCycle, AJogsLaddersAreACycleOfTheirOwn) {
    loaded_.machine.guard.jog.is_promised = true;
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        loaded_.machine.cycle.stages = stages;
        const CycleDemand demand = cycle_demand(loaded_.machine, true);
        const std::vector<WorstCaseCycle> made = cycles(true);
        ASSERT_EQ(made.size(), 2U);
        EXPECT_EQ(made[0].calls.size(), stages + (stages == 3 ? kRoundsMax : 0));
        ASSERT_EQ(made[1].calls.size(), 3U) << "margins, rungs, known-answer test";
        EXPECT_EQ(launches_of(made[1]), 3U);
        const JogLists lists = jog_lists(*demand.plan);
        expect_no_less(made[1].calls[0], lists.margins);
        expect_no_less(made[1].calls[1], lists.rungs);
        EXPECT_EQ(made[1].calls[0].queries, demand.tasks);
        EXPECT_EQ(made[1].calls[1].queries,
                  std::min(demand.tasks, jog_ladders(*demand.plan)) * (kJogRungs - 1));
    }
}

// So what a thread does where a jog begins is within what it does in the longest cycle of the plan.
TEST_F(LongestGpuCycle, AJogMayUseNoMoreThanAPlan) {
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        for (const std::uint32_t queries : {15U, 16U, 64U, 512U, 1024U}) {
            const CyclePlan plan = plan_of(stages, 8, queries, {512, 384, 2048, 3072, 64});
            const WorkLists all = lists_of(plan);
            const auto [margins, rungs] = jog_lists(plan);
            EXPECT_LE(margins.node_pairs + rungs.node_pairs, all.node_pairs);
            EXPECT_LE(margins.leaf_pairs + rungs.leaf_pairs, all.leaf_pairs);
            EXPECT_LE(margins.box_rows + rungs.box_rows, all.box_rows);
            EXPECT_LE(margins.triangle_pairs + rungs.triangle_pairs, all.triangle_pairs);
            EXPECT_LE(margins.rechecks + rungs.rechecks, all.rechecks);
            EXPECT_LE(jog_ladders(plan) * (kJogRungs - 1), plan.queries[stages - 1]);
            EXPECT_GE(jog_ladders(plan), 1U);
        }
    }
}

TEST_F(LongestGpuCycle, InContactModeItIsOneBatchOfTheFilesLists) {
    const WorstCaseCycle made = cycles(false).front();
    ASSERT_EQ(made.calls.size(), 1U);
    EXPECT_FALSE(made.calls[0].is_stage);
    const BatchCapacities &found = made.calls[0].capacities.batch,
                          &wanted = loaded_.machine.capacities.batch;
    EXPECT_EQ(found.leaf_pairs, wanted.leaf_pairs);
    EXPECT_EQ(found.triangle_pairs, wanted.triangle_pairs);
    EXPECT_EQ(found.rechecks, wanted.rechecks);
    EXPECT_EQ(launches_of(made), 1U);
}

TEST_F(LongestGpuCycle, MoreQueriesThanALaunchTakesAreMoreLaunches) {
    loaded_.machine.guard.jog.is_promised = false;
    loaded_.machine.plan = plan_of(2, stop_tasks(loaded_.machine), 1024, {512, 512, 4096, 4096, 0});
    const WorstCaseCycle made = cycles(true).front();
    ASSERT_EQ(made.calls.size(), 2U);
    EXPECT_EQ(made.calls[1].times, 2U);
    EXPECT_EQ(made.calls[1].queries, CudaOptions{}.queries_max);
}

// Boxes of the later stages are posed by the engine, unless a path is announced: its pieces are the
// host's.
TEST_F(LongestGpuCycle, TheEnginePosesTheLaterStages) {
    const CyclePlan plan = *cycle_demand(loaded_.machine, true).plan;
    ASSERT_EQ(plan.stages, 3U);
    const std::vector<WorstCaseCall> calls = cycles(true)[0].calls;
    EXPECT_EQ(calls[0].roots_max, 0U);
    EXPECT_EQ(calls[1].roots_max, 0U) << "whole boxes once more";
    EXPECT_EQ(calls[2].roots_max, stop_tasks(loaded_.machine));
    EXPECT_EQ(calls.back().roots_max, plan.queries[1]);
    EXPECT_EQ(calls.back().trees_max, stop_tasks(loaded_.machine));
    loaded_.machine.can.look_ahead_samples = 8;
    const std::vector<WorstCaseCall> with_path = cycles(true)[0].calls;
    for (const WorstCaseCall& call : with_path) {
        EXPECT_EQ(call.roots_max, 0U);
    }
}

// No launch has what the host does between them: an admission adds it.
TEST_F(LongestGpuCycle, TheHostsShareIsMeasured) {
    std::string fault;
    const std::optional<double> share =
        host_share_us(loaded_, cycle_demand(loaded_.machine, true), fault);
    ASSERT_TRUE(share) << fault;
    EXPECT_GT(*share, 0);
    EXPECT_EQ(host_share_us(loaded_, cycle_demand(loaded_.machine, false), fault), 0.0);
}

// Stages that the host answers are no launches.
TEST_F(LongestGpuCycle, StagesOfTheHostAreNoLaunches) {
    CycleDemand demand = cycle_demand(loaded_.machine, true);
    const std::vector<WorstCaseCall> all = cycles(true)[0].calls;
    ASSERT_EQ(all.size(), 3 + kRoundsMax);
    std::string fault;
    for (const std::uint32_t of_host : {0U, 1U, 2U}) {
        demand.host_stages = of_host;
        const std::vector<WorstCaseCycle> made =
            longest_gpu_cycles(loaded_.machine.capacities, demand, kLevels);
        const std::size_t first = of_host == 2 ? 2 + kRoundsMax : of_host;
        ASSERT_EQ(made[0].calls.size(), all.size() - first);
        for (std::size_t i = 0; i < made[0].calls.size(); ++i) {
            EXPECT_EQ(made[0].calls[i].queries, all[first + i].queries);
            EXPECT_EQ(made[0].calls[i].capacities.batch.leaf_pairs,
                      all[first + i].capacities.batch.leaf_pairs);
        }
        const std::optional<double> us = host_share_us(loaded_, demand, fault);
        ASSERT_TRUE(us) << fault;
        EXPECT_GT(*us, 0);
    }
}

// Each call can be constructed, in every layout.
TEST_F(LongestGpuCycle, EveryCallCanBeFilled) {
    loaded_.machine.guard.jog.is_promised = true;
    for (const std::uint32_t levels : {1U, 2U, 3U}) {
        for (const WorstCaseCycle& made : cycles(true, levels)) {
            for (const WorstCaseCall& call : made.calls) {
                for (const WorstCaseLayout layout : kWorstCaseLayouts) {
                    WorstCaseBatch batch;
                    EXPECT_EQ(
                        make_worst_case_batch(call.capacities, call.queries, levels, layout, batch),
                        "")
                        << levels << " levels, " << call.queries << " queries, " << name_of(layout);
                }
            }
        }
    }
}

}  // namespace
}  // namespace axg
