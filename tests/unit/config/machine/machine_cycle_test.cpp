// SPDX-License-Identifier: Apache-2.0
// The section `cycle` of a machine file: what each key comes to, and what is refused.
#include <gtest/gtest.h>

#include <string>

#include "config/machine/effective_text.hpp"
#include "config/machine/parse_machine.hpp"
#include "core/machine/cycle_plan.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

std::string faults_of_section(const std::string& section) {
    Machine machine;
    std::string all;
    for (const ConfigFault& fault : parse_machine(kSmallMachine + section, "m", machine)) {
        all += to_string(fault) + '\n';
    }
    return all;
}

Machine loaded_with(const std::string& section) {
    Machine machine;
    EXPECT_TRUE(parse_machine(kSmallMachine + section, "m", machine).empty()) << section;
    return machine;
}

TEST(MachineCycle, WithoutAWordAndWithAutoItIsTheUsualPlan) {
    for (const char* section : {"", "cycle: auto\n"}) {
        const Machine machine = loaded_with(section);
        EXPECT_EQ(machine.cycle, CycleRules{});
        const CyclePlan plan = default_plan(machine, 8);
        EXPECT_EQ(plan.stages, 3U);
        EXPECT_EQ(plan.form, TreeForm::leaves);
        EXPECT_EQ(plan.queries[0], 24U) << "three queries a pair";
        EXPECT_EQ(plan.queries[1], 32U);
        EXPECT_EQ(plan.queries[2], 512U);
        EXPECT_EQ(lists_of(plan), (WorkLists{192, 240, 2816, 2240, 0}));
        EXPECT_EQ(plan.depth_max, kStageDepthMax);
    }
}

TEST(MachineCycle, EachKeyArrivesAndIsPartOfTheHash) {
    const std::string usual = effective_text(loaded_with(""));
    const auto changed = [&usual](const std::string& section) {
        const Machine machine = loaded_with("cycle: " + section + "\n");
        EXPECT_NE(effective_text(machine), usual) << section;
        EXPECT_TRUE(machine.cycle.is_pinned);
        return default_plan(machine, 8);
    };
    EXPECT_EQ(changed("{stages: 3}"), default_plan(loaded_with(""), 8)) << "pinned, and the same";
    EXPECT_EQ(changed("{stages: 2}").stages, 2U);
    EXPECT_EQ(changed("{queries: 256}").queries[2], 256U);
    EXPECT_EQ(lists_of(changed("{lists: {node_pairs: 8}}")).node_pairs, 8U);
    EXPECT_EQ(lists_of(changed("{lists: {leaf_pairs: 1048576}}")).leaf_pairs, 1048576U);
    EXPECT_EQ(lists_of(changed("{lists: {box_rows: 100}}")).box_rows, 100U);
    EXPECT_EQ(lists_of(changed("{lists: {triangle_pairs: 1000}}")).triangle_pairs, 1000U);
    EXPECT_EQ(lists_of(changed("{lists: {rechecks: 64}}")).rechecks, 64U);
}

TEST(MachineCycle, APlanThatWasChosenGoesBeforeTheFile) {
    Machine machine = loaded_with("cycle: {stages: 3}\n");
    EXPECT_EQ(cycle_plan(machine, 8), default_plan(machine, 8));
    machine.plan = plan_of(2, 8, 100, {1, 2, 3, 4, 5});
    EXPECT_EQ(cycle_plan(machine, 8), *machine.plan);
}

TEST(MachineCycle, WhatIsRefusedIsNamed) {
    EXPECT_EQ(faults_of_section("cycle: often\n").find("m:"), 0U);
    EXPECT_NE(faults_of_section("cycle: often\n")
                  .find("cycle: invalid value (found \"often\", expected auto, or a map"),
              std::string::npos)
        << faults_of_section("cycle: often\n");
    for (const char* section :
         {"cycle: 3\n", "cycle: [3]\n", "cycle: {stages: 1}\n", "cycle: {stages: 4}\n",
          "cycle: {queries: 1}\n", "cycle: {queries: 65537}\n", "cycle: {rounds: 7}\n",
          "cycle: {lists: 512}\n", "cycle: {lists: {node_pairs: 7}}\n",
          "cycle: {lists: {leaf_pairs: 1048577}}\n", "cycle: {lists: {box_rows: 31}}\n",
          "cycle: {lists: {triangle_pairs: 31}}\n", "cycle: {lists: {rechecks: -1}}\n",
          "cycle: {lists: {pairs: 9}}\n"}) {
        EXPECT_NE(faults_of_section(section), "") << section;
    }
}

}  // namespace
}  // namespace axg::test
