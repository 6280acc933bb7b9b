// SPDX-License-Identifier: Apache-2.0
// Of which calls the longest cycle on a GPU consists: each stage with its own lists full, a jog's
// calls with the longest of any stage, in contact mode one batch. No GPU is needed.
#include "firmware_if/setup/longest_gpu_cycle.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/certificate/stop_certificate.hpp"
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
    [[nodiscard]] WorstCaseCycle cycle(bool is_stoppable) const {
        return longest_gpu_cycle(loaded_.machine.capacities,
                                 cycle_demand(loaded_.machine, is_stoppable), kLevels);
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
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        loaded_.machine.cycle.stages = stages;
        const CycleDemand demand = cycle_demand(loaded_.machine, true);
        const WorstCaseCycle made = cycle(true);
        EXPECT_EQ(made.tree_levels, kLevels);
        ASSERT_EQ(made.calls.size(), stages);
        EXPECT_EQ(launches_of(made), stages);
        for (std::uint32_t stage = 0; stage < stages; ++stage) {
            expect_no_less(made.calls[stage], demand.plan->lists[stage]);
            EXPECT_EQ(made.calls[stage].queries,
                      2 + (stage == 0 ? demand.tasks : demand.plan->queries[stage]));
        }
    }
}

// A mean of the stages would be no bound: a ladder may fill what any stage may.
TEST_F(LongestGpuCycle, AJogsCallsHaveTheLongestListsOfAnyStage) {
    loaded_.machine.guard.jog.is_promised = true;
    const CycleDemand demand = cycle_demand(loaded_.machine, true);
    const WorstCaseCycle made = cycle(true);
    ASSERT_EQ(made.calls.size(), demand.plan->stages + 1);
    EXPECT_EQ(made.calls.back().times, 2U);
    EXPECT_EQ(made.calls.back().queries, demand.queries);
    for (std::uint32_t stage = 0; stage < demand.plan->stages; ++stage) {
        expect_no_less(made.calls.back(), demand.plan->lists[stage]);
    }
    EXPECT_EQ(launches_of(made), demand.calls);
}

TEST_F(LongestGpuCycle, InContactModeItIsOneBatchOfTheFilesLists) {
    const WorstCaseCycle made = cycle(false);
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
    const WorstCaseCycle made = cycle(true);
    ASSERT_EQ(made.calls.size(), 2U);
    EXPECT_EQ(made.calls[1].times, 2U);
    EXPECT_EQ(made.calls[1].queries, CudaOptions{}.queries_max);
}

// Each call can be constructed, in every layout.
TEST_F(LongestGpuCycle, EveryCallCanBeFilled) {
    loaded_.machine.guard.jog.is_promised = true;
    for (const std::uint32_t levels : {1U, 2U, 3U}) {
        const WorstCaseCycle made = longest_gpu_cycle(loaded_.machine.capacities,
                                                      cycle_demand(loaded_.machine, true), levels);
        for (const WorstCaseCall& call : made.calls) {
            for (const WorstCaseLayout layout : kWorstCaseLayouts) {
                WorstCaseBatch batch;
                EXPECT_EQ(
                    make_worst_case_batch(call.capacities, call.queries, levels, layout, batch), "")
                    << levels << " levels, " << call.queries << " queries, " << name_of(layout);
            }
        }
    }
}

}  // namespace
}  // namespace axg
