// SPDX-License-Identifier: Apache-2.0
// The key for homing of the component for LinuxCNC: commands pass without a permit from rest on
// until all joints are homed, never while the board is armed, and never for a joint that loses its
// home in motion.
#include "firmware_if/linuxcnc/axguard_home.h"

#include <gtest/gtest.h>

#include "tests/support/board_fixture.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kAfterwards = 500'000;

class HomeKey : public ::testing::Test, public test::BoardFixture {
  protected:
    /// One servo period: whether the key has opened by its turn.
    bool period(bool key, bool wants, bool rests) {
        return axg_home_turn_key(&home, &board, key, wants, rests, kAfterwards);
    }

    axg_home home{};
};

TEST_F(HomeKey, OpensAtRestAndStaysOpenWhileTheJointsTravel) {
    EXPECT_TRUE(period(true, true, true));
    EXPECT_FALSE(period(true, true, false)) << "once for a turn";
    EXPECT_TRUE(home.is_open);
}

TEST_F(HomeKey, ClosesWhenAllJointsAreHomedAndByItsReturn) {
    (void)period(true, true, true);
    (void)period(true, false, false);
    EXPECT_FALSE(home.is_open) << "homed";
    (void)period(true, true, false);
    EXPECT_FALSE(home.is_open) << "a joint that loses its home in motion opens nothing";
    (void)period(false, true, true);
    (void)period(true, true, true);
    (void)period(false, true, false);
    EXPECT_FALSE(home.is_open) << "turned back";
}

TEST_F(HomeKey, LeftTurnedItOpensNothingInMotionForAJointThatLosesItsHome) {
    (void)period(true, false, true);
    begin();
    ASSERT_EQ(board.phase, AXG_BOARD_ARMED);
    EXPECT_FALSE(period(true, true, false));
    EXPECT_FALSE(home.is_open);
    EXPECT_EQ(board.phase, AXG_BOARD_ARMED) << "the guard decides, not the key";
}

TEST_F(HomeKey, StopsAnArmedBoardWhenItOpens) {
    arm();
    ASSERT_EQ(board.phase, AXG_BOARD_ARMED);
    EXPECT_TRUE(period(true, true, true));
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    (void)axg_board_arm(&board, 0xBEEF01, kAfterwards);
    ASSERT_EQ(board.phase, AXG_BOARD_ARMED);
    (void)period(true, true, false);
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED) << "nobody arms while the joints travel";
}

TEST_F(HomeKey, AConstantSignalOpensNothing) {
    home.key_before = true;  // as when the component is loaded
    EXPECT_FALSE(period(true, true, true));
    EXPECT_FALSE(home.is_open);
    (void)period(false, true, true);
    (void)period(true, false, true);  // turned while all are homed
    (void)period(true, true, true);
    EXPECT_FALSE(home.is_open) << "turned before a joint lost its home";
}

}  // namespace
}  // namespace axg
