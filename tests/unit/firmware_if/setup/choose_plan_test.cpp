// SPDX-License-Identifier: Apache-2.0
// ctest-labels: long
// Plans of the fixed shape, and what is chosen or refused at a deadline. Times are this machine's:
// deadlines are so long, or so short, that they decide nothing.
#include "firmware_if/setup/choose_plan.hpp"

#include <gtest/gtest.h>

#include "core/certificate/stop_certificate.hpp"
#include "core/machine/cycle_plan.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class ChoosePlan : public testing::Test {
  protected:
    void SetUp() override { ASSERT_TRUE(load(test::kPaperMachine, "", loaded, stderr)); }
    ChosenPlan chosen(std::uint32_t deadline_us) {
        loaded.machine.deadline_us = deadline_us;
        std::string fault;
        const std::optional<ChosenPlan> out = choose_plan(loaded, fault);
        EXPECT_TRUE(out) << fault;
        return out.value_or(ChosenPlan{});
    }
    [[nodiscard]] CyclePlan at(std::uint32_t step) const {
        return plan_at(loaded.machine, stop_tasks(loaded.machine), step);
    }
    LoadedMachine loaded;
};

TEST_F(ChoosePlan, OneStepHasTheListsOfTheMachineFile) {
    EXPECT_EQ(at(kPlanStepAsStated), default_plan(loaded.machine, stop_tasks(loaded.machine)));
    for (std::uint32_t step = 1; step < kPlanSteps; ++step) {
        const WorkLists shorter = lists_of(at(step - 1)), longer = lists_of(at(step));
        EXPECT_LE(shorter.triangle_pairs, longer.triangle_pairs);
        EXPECT_LE(shorter.box_rows, longer.box_rows);
        EXPECT_LT(shorter.triangle_pairs + shorter.box_rows,
                  longer.triangle_pairs + longer.box_rows);
    }
    for (std::uint32_t step = 0; step < kPlanSteps; ++step) {  // what a person pins is the same
        const CyclePlan plan = at(step);
        EXPECT_EQ(plan_of(plan.stages, stop_tasks(loaded.machine), plan.queries[2], lists_of(plan)),
                  plan);
    }
    EXPECT_EQ(format_plan_key(at(0)),
              "cycle: {stages: 3, queries: 512, lists: {node_pairs: 64, leaf_pairs: 50, box_rows: "
              "821, triangle_pairs: 513, rechecks: 0}}");
    loaded.machine.cycle.queries = 64;
    EXPECT_EQ(at(0).queries[2], 64U);
}

TEST_F(ChoosePlan, TimeEnoughTakesTheLongestLists) {
    const ChosenPlan plan = chosen(1'000'000);
    EXPECT_TRUE(plan.is_fit);
    EXPECT_EQ(plan.plan, at(kPlanSteps - 1));
    EXPECT_GT(plan.longest_us, plan.posing_us);
    EXPECT_GT(plan.posing_us, 0);
}

TEST_F(ChoosePlan, ADeadlineThatNoListsFitIsRefusedWithTheLeastThatDoes) {
    const ChosenPlan plan = chosen(10);
    EXPECT_FALSE(plan.is_fit);
    EXPECT_EQ(plan.plan, at(0));
    EXPECT_GE(static_cast<double>(plan.least_deadline_us) * kEngineShare, plan.longest_us);
    EXPECT_NE(plan.words.find("Raise deadline_us to " + std::to_string(plan.least_deadline_us)),
              std::string::npos)
        << plan.words;
}

TEST_F(ChoosePlan, APinnedPlanIsMeasuredAndNotReplaced) {
    loaded.machine.cycle.is_pinned = true;
    loaded.machine.cycle.lists = {64, 64, 512, 512, 0};
    const ChosenPlan plan = chosen(1'000'000);
    EXPECT_TRUE(plan.is_fit);
    EXPECT_EQ(plan.plan, at(kPlanStepAsStated));
    EXPECT_FALSE(chosen(10).is_fit);
}

TEST_F(ChoosePlan, ListsThatDoNotGoTogetherAreAFault) {
    CyclePlan plan = at(kPlanStepAsStated);
    plan.lists[1].box_rows = 1;
    std::string fault;
    EXPECT_FALSE(judge_plan(loaded, plan, fault));
    EXPECT_NE(fault.find("box_rows"), std::string::npos);
}

}  // namespace
}  // namespace axg
