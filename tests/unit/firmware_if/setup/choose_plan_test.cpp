// SPDX-License-Identifier: Apache-2.0
// Plans of the fixed shape, and what is chosen or refused at a deadline. Times are this machine's:
// deadlines are so long, or so short, that they decide nothing.
#include "firmware_if/setup/choose_plan.hpp"

#include <gtest/gtest.h>

#include "core/certificate/stop_certificate.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class ChoosePlan : public testing::Test {
  protected:
    void SetUp() override { ASSERT_TRUE(load(test::kPaperMachine, "", loaded, stderr)); }
    ChosenPlan chosen(std::uint32_t deadline_us, const std::optional<CyclePlan>& pinned = {}) {
        loaded.machine.deadline_us = deadline_us;
        std::string fault;
        const std::optional<ChosenPlan> out = choose_plan(loaded, pinned, fault);
        EXPECT_TRUE(out) << fault;
        return out.value_or(ChosenPlan{});
    }
    LoadedMachine loaded;
};

TEST(PlanAt, HasOneShapeOfLists) {
    const CyclePlan plan = plan_at({.stages = 2, .leaf_pairs = 512}, 8);
    EXPECT_EQ(lists_in(plan), (WorkLists{512, 512, 2048, 4096, 0}));
    EXPECT_EQ(plan.queries[0], 24U);
    EXPECT_EQ(plan.queries[1], kPlanQueries);
    EXPECT_EQ(to_text(plan),
              "2 stages, 24 + 510 queries, 512 node pairs, 512 leaf pairs, 2048 box rows, 4096 "
              "triangle pairs, 0 rechecks");
}

TEST_F(ChoosePlan, TimeEnoughTakesTheLongestListsInThreeStages) {
    const ChosenPlan plan = chosen(1'000'000);
    EXPECT_TRUE(plan.is_fit);
    EXPECT_EQ(plan.plan.stages, 3U);
    EXPECT_EQ(lists_in(plan.plan).leaf_pairs, 2048U);
    EXPECT_GT(plan.longest_us, plan.posing_us);
    EXPECT_GT(plan.posing_us, 0);
}

TEST_F(ChoosePlan, ADeadlineThatNoListsFitIsRefusedWithTheLeastThatDoes) {
    const ChosenPlan plan = chosen(10);
    EXPECT_FALSE(plan.is_fit);
    EXPECT_EQ(lists_in(plan.plan).leaf_pairs, kLeafPairsMin);
    EXPECT_GE(static_cast<double>(plan.least_deadline_us) * kEngineShare, plan.longest_us);
    EXPECT_NE(plan.words.find("raise deadline_us to " + std::to_string(plan.least_deadline_us)),
              std::string::npos)
        << plan.words;
}

TEST_F(ChoosePlan, APinnedPlanIsMeasuredAndNotReplaced) {
    const CyclePlan pinned = plan_at({.stages = 2, .leaf_pairs = 100}, 8);
    const ChosenPlan plan = chosen(1'000'000, pinned);
    EXPECT_TRUE(plan.is_fit);
    EXPECT_EQ(to_text(plan.plan), to_text(pinned));
    EXPECT_FALSE(chosen(10, pinned).is_fit);
}

TEST_F(ChoosePlan, ListsThatDoNotGoTogetherAreAFault) {
    CyclePlan pinned = plan_at({}, 8);
    pinned.lists[1].box_rows = 1;
    std::string fault;
    EXPECT_FALSE(choose_plan(loaded, pinned, fault));
    EXPECT_NE(fault.find("box_rows"), std::string::npos);
}

}  // namespace
}  // namespace axg
