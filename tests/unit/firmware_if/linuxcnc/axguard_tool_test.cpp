// SPDX-License-Identifier: Apache-2.0
// The tool change of the component for LinuxCNC. By permit it follows the board library; by a
// person's key it goes on in a stop, and neither the key nor the change ever permits motion.
#include "firmware_if/linuxcnc/axguard_tool.h"

#include <gtest/gtest.h>

#include "tests/support/board_fixture.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kLater = 500'000;

class ToolChange : public ::testing::Test, public test::BoardFixture {
  protected:
    ToolChange() { tool.number = 3; }

    /// One servo period at rest.
    void period(bool key, bool rests = true) {
        has_opened = axg_tool_turn_key(&tool, &board, key, rests);
        const bool is_permitted = may_move(kLater);
        axg_tool_advance(&tool, &board, &pins, is_permitted, kLater);
        EXPECT_FALSE(is_permitted && board.phase == AXG_BOARD_STOPPED);
        EXPECT_EQ(axg_board_may_move(&board, kLater).may_move, is_permitted);
    }
    /// Stopped by the guard, at rest; the key has turned if `is_turned`.
    void stop(bool is_turned) {
        arm();
        axg_board_stop(&board, kLater);
        ASSERT_EQ(board.phase, AXG_BOARD_STOPPED);
        period(false);
        period(is_turned);
    }

    axg_tool tool{};
    axg_tool_pins pins{};
    bool has_opened = false;
};

TEST_F(ToolChange, AStopForbidsItWithoutAPerson) {
    stop(false);
    pins = {.wants = true, .is_done = true, .number = 1};
    for (int i = 0; i < 10; ++i) {
        period(false);
    }
    EXPECT_EQ(tool.step, AXG_TOOL_NONE);
    EXPECT_EQ(tool.number, 3);
}

TEST_F(ToolChange, ByAPersonsKeyItGoesOnInAStopAndPermitsNothing) {
    stop(true);
    EXPECT_TRUE(has_opened);
    pins = {.wants = true, .is_done = false, .number = 1};
    period(true);
    EXPECT_FALSE(has_opened) << "once for a turn";
    EXPECT_EQ(tool.step, AXG_TOOL_UNGUARDED);
    EXPECT_TRUE(axg_tool_is_out(&tool));
    EXPECT_TRUE(axg_tool_is_announced(&tool)) << "the guard accepts no reset meanwhile";
    EXPECT_EQ(tool.number, 3) << "until it is done";
    period(false);
    EXPECT_EQ(tool.step, AXG_TOOL_UNGUARDED) << "the key returns: no changer stops half-way";
    EXPECT_TRUE(axg_tool_is_unguarded(&tool)) << "nobody arms, and no axis homes";
    pins.is_done = true;
    period(false);
    EXPECT_EQ(tool.number, 1);
    EXPECT_FALSE(axg_tool_is_announced(&tool));
    EXPECT_FALSE(axg_tool_is_unguarded(&tool));
    period(false);
    EXPECT_EQ(tool.step, AXG_TOOL_PERMIT) << "LinuxCNC waits for the first permit";
}

TEST_F(ToolChange, AConstantSignalIsNoTurn) {
    tool.key_before = true;  // as the component is loaded
    arm();
    axg_board_stop(&board, kLater);
    pins = {.wants = true, .is_done = true, .number = 1};
    for (int i = 0; i < 10; ++i) {
        period(true);
    }
    EXPECT_EQ(tool.step, AXG_TOOL_NONE);
}

TEST_F(ToolChange, AKeyTurnedBeforeTheStopOrInMotionOpensNothing) {
    arm();
    period(false);
    period(true);
    axg_board_stop(&board, kLater);
    period(true);
    EXPECT_FALSE(tool.is_open) << "turned while armed";
    period(false, false);
    period(true, false);
    period(true);
    EXPECT_FALSE(tool.is_open) << "turned in motion";
    period(false);
    period(true);
    EXPECT_TRUE(tool.is_open);
    period(true, false);
    EXPECT_FALSE(tool.is_open) << "motion closes it";
    period(true);
    EXPECT_FALSE(tool.is_open) << "until it is turned anew";
}

TEST_F(ToolChange, ArmingClosesTheKey) {
    stop(true);
    ASSERT_TRUE(tool.is_open);
    ASSERT_EQ(axg_board_arm(&board, 0xBEEF, kLater), AXG_BOARD_ARMING_DONE);
    period(true);
    EXPECT_FALSE(tool.is_open);
    pins = {.wants = true, .is_done = true, .number = 1};
    period(true);
    EXPECT_EQ(tool.step, AXG_TOOL_WANTED) << "by the rules of the board from here on";
}

TEST_F(ToolChange, AStoppedChangeGoesOnByTheKey) {
    arm();
    pins = {.wants = true, .is_done = false, .number = 1};
    period(false);
    ASSERT_EQ(tool.step, AXG_TOOL_WANTED);
    axg_board_stop(&board, kLater);
    period(false);
    EXPECT_EQ(tool.step, AXG_TOOL_WANTED);
    period(true);
    EXPECT_EQ(tool.step, AXG_TOOL_UNGUARDED);
    pins.wants = false;
    period(true);
    EXPECT_EQ(tool.step, AXG_TOOL_NONE) << "LinuxCNC gave it up";
    EXPECT_EQ(tool.number, 3);
}

TEST_F(ToolChange, AChangeThatIsDoneIsNotBegunAgainByArming) {
    stop(true);
    pins = {.wants = true, .is_done = true, .number = 1};
    period(true);
    period(true);
    ASSERT_EQ(tool.step, AXG_TOOL_PERMIT);
    axg_tool_on_armed(&tool);
    EXPECT_EQ(tool.step, AXG_TOOL_PERMIT);
    for (const axg_tool_step step : {AXG_TOOL_WANTED, AXG_TOOL_OUT}) {
        tool.step = step;
        axg_tool_on_armed(&tool);
        EXPECT_EQ(tool.step, AXG_TOOL_NONE) << step;
    }
}

TEST_F(ToolChange, ByPermitItWaitsForTheHorizonAndForTheNextPermit) {
    begin();
    axg_board_moves(&board, false, instant_of(3) + 600);
    pins = {.wants = true, .is_done = false, .number = 1};
    const auto advance = [this](std::uint64_t at_us) {
        axg_tool_advance(&tool, &board, &pins, may_move(at_us), at_us);
    };
    advance(instant_of(3) + 700);
    ASSERT_EQ(tool.step, AXG_TOOL_WANTED);
    std::uint32_t number = 4;
    for (; tool.step == AXG_TOOL_WANTED && number < 60; ++number) {
        ASSERT_TRUE(latch(number));
        (void)hear({.number = number, .live = static_cast<std::uint8_t>(number + 1)},
                   instant_of(number) + 100);
        advance(instant_of(number) + 200);
    }
    EXPECT_GE(number, 4 + axg_board_horizon_us(&options, 15) / 1000);
    ASSERT_EQ(tool.step, AXG_TOOL_OUT);
    pins.is_done = true;
    advance(instant_of(number));
    EXPECT_EQ(tool.step, AXG_TOOL_PERMIT);
    EXPECT_FALSE(may_move(instant_of(number))) << "another tool: all permits are forgotten";
    advance(instant_of(number) + 100);
    EXPECT_EQ(tool.step, AXG_TOOL_PERMIT);
    axg_tool_advance(&tool, &board, &pins, true, instant_of(number) + 200);
    EXPECT_EQ(tool.step, AXG_TOOL_DONE);
}

}  // namespace
}  // namespace axg
