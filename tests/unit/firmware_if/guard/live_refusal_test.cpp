// SPDX-License-Identifier: Apache-2.0
// What no guard may run on: every reason is listed at once, each with its place in the file.
#include "firmware_if/guard/live_refusal.hpp"

#include <gtest/gtest.h>

#include "firmware_if/guard/standstill_watch.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "tests/support/can_board.hpp"

namespace axg {
namespace {

TEST(LiveRefusal, ListsEveryReason) {
    const Machine drives = test::five_axis_machine(CanFormat::cia402);  // no counter, one velocity
    const std::vector<std::string> wanted{"guard.obeyed_by: " + obeyed_by_refusal(drives),
                                          standstill_refusal(drives)};
    EXPECT_EQ(live_refusals(drives), wanted);
    Machine counted = drives;
    counted.can.sync_counter_max = 240;
    EXPECT_EQ(live_refusals(counted), std::vector<std::string>{standstill_refusal(drives)});
}

TEST(LiveRefusal, FramesOfOurOwnAreRefusedNothing) {
    EXPECT_TRUE(live_refusals(test::five_axis_machine(CanFormat::classical)).empty());
    EXPECT_TRUE(live_refusals(test::five_axis_machine(CanFormat::fd)).empty());
}

// A guard may run, but a person has to know.
TEST(LiveRefusal, HashesThatNobodyComparesAreAWarning) {
    Machine machine = test::five_axis_machine(CanFormat::classical);
    machine.can.hashes_in_id = 0x582;
    machine.can.hashes_out_id = 0x602;
    EXPECT_TRUE(live_warnings(machine).empty());
    machine.can.hashes_in_id = machine.can.hashes_out_id = 0;
    ASSERT_EQ(live_warnings(machine).size(), 1U);
    EXPECT_EQ(live_warnings(machine)[0].rfind("can.hashes: none: ", 0), 0U);
    EXPECT_TRUE(live_refusals(machine).empty());
}

TEST(LiveRefusal, BrokenLimitsMustStop) {
    Machine machine = test::five_axis_machine(CanFormat::classical);
    machine.guard.reports_limits = true;
    const std::vector<std::string> refusals = live_refusals(machine);
    ASSERT_EQ(refusals.size(), 1U);
    EXPECT_EQ(refusals[0].rfind("guard.limits_broken: report", 0), 0U) << refusals[0];
}

}  // namespace
}  // namespace axg
