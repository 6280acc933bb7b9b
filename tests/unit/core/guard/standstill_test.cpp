// SPDX-License-Identifier: Apache-2.0
// Standstill is a matter of a whole window: every way in which less evidence looks like rest.
#include "core/guard/standstill.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/sincos.hpp"
#include "tests/support/can_board.hpp"

namespace axg {
namespace {

using namespace test;

constexpr double kCount = 0.001;

StandstillRules rules_of(const Machine& machine) {
    const std::array<double, 5> count{kCount, kCount, kCount, 2e-5, 2e-5};
    return standstill_rules(machine, count);
}

Machine still_machine() {
    Machine machine = five_axis_machine(CanFormat::classical);
    for (Axis& axis : machine.axes) {
        axis.position_error = axis.kind == AxisKind::rotary ? 1e-5 : 5e-4;
    }
    return machine;
}

/// A board and the guard's view of it: sample k is latched at k ms.
struct Board {
    Machine machine = still_machine();
    StandstillRules rules = rules_of(machine);
    Standstill state;
    AxisSnapshot snapshot = at_rest();

    static AxisSnapshot at_rest() {
        AxisSnapshot snapshot;
        snapshot.axis_count = 5;
        snapshot.position = {10, 20, 30, 0.5, 0.25};
        return snapshot;
    }
    [[nodiscard]] bool note(std::uint64_t sample, bool is_reported_still = true) {
        snapshot.sample = sample;
        snapshot.latched_us = static_cast<std::int64_t>(sample) * machine.can.sample_us;
        note_standstill(state, rules, snapshot, is_reported_still);
        return stands(state, rules, snapshot.latched_us);
    }
    /// The first sample at which it stands, of those from `first` on; or `end`.
    [[nodiscard]] std::uint64_t first_stand(std::uint64_t first, std::uint64_t end) {
        for (std::uint64_t k = first; k < end; ++k) {
            if (note(k)) {
                return k;
            }
        }
        return end;
    }
};

// 100 ms of a period that may be 1 % shorter.
TEST(Standstill, AnAxisAtRestStandsAfterTheWindowAndNotBefore) {
    Board board;
    EXPECT_EQ(board.rules.window_samples, 102U);
    EXPECT_EQ(board.first_stand(1000, 2000), 1102U);
}

// What was latched up to the age after a stop may be of before it.
TEST(Standstill, PositionsOfBeforeTheStopDoNotCount) {
    Board board;
    board.machine.can.latched_age = {0, 5000};  // in the longest periods, 5050 us
    board.rules = rules_of(board.machine);
    const std::uint64_t window = board.rules.window_samples;
    begin_standstill(board.state, 1000 * 1000);
    EXPECT_EQ(board.first_stand(1000, 2000), 1006 + window);
}

TEST(Standstill, AMachineThatComesToRestStandsWithin150Ms) {
    Board board;
    for (std::uint64_t k = 0; k < 500; ++k) {
        board.snapshot.position[1] = 0.02 * static_cast<double>(k);
        EXPECT_FALSE(board.note(k));
    }
    EXPECT_LT(board.first_stand(500, 1000), 650U);
}

// One resting axis, a mode byte and a single frame were each believed before.
TEST(Standstill, NoAxisMayMoveWhateverTheModeSays) {
    for (std::uint32_t axis = 0; axis < 5; ++axis) {
        Board board;
        for (std::uint64_t k = 0; k < 1000; ++k) {
            board.snapshot.position[axis] =
                Board::at_rest().position[axis] + 0.125 * std::sin(static_cast<double>(k));
            EXPECT_FALSE(board.note(k)) << axis;
        }
    }
}

// Two counts and two position errors: 3 um here.
TEST(Standstill, TheWidthIsKeptOnBothSides) {
    for (const double swing_mm : {0.00299, 0.00301}) {
        Board board;
        std::uint64_t stood = 0;
        for (std::uint64_t k = 0; k < 400; ++k) {
            board.snapshot.position[0] = 10 + (k % 50 == 0 ? swing_mm : 0.0);
            stood += board.note(k) ? 1 : 0;
        }
        EXPECT_EQ(stood, swing_mm < 0.003 ? 400U - 102U : 0U);
    }
}

TEST(Standstill, NoSampleOfTheWindowReportsMotion) {
    for (const std::uint8_t mode : {kModeMoving, kModeToolChange}) {
        Board board;
        EXPECT_EQ(board.first_stand(0, 200), 102U);
        board.snapshot.mode = mode;
        EXPECT_FALSE(board.note(200));
        board.snapshot.mode = kModeStandstill;
        EXPECT_EQ(board.first_stand(201, 400), 303U);
    }
}

// A way out of an obstacle: it is armed when the board reports it, before it begins.
TEST(Standstill, AJogStandsUntilItsAxisMoves) {
    Board board;
    EXPECT_EQ(board.first_stand(0, 200), 102U);
    board.snapshot.mode = kModeJog;
    EXPECT_TRUE(board.note(103));
    board.snapshot.position[2] += 0.0031;
    EXPECT_FALSE(board.note(104));
}

TEST(Standstill, APathThatGoesOnIsNoStandstill) {
    Board board;
    EXPECT_EQ(board.first_stand(0, 200), 102U);
    EXPECT_FALSE(board.note(103, false));
    EXPECT_EQ(board.first_stand(104, 400), 206U);
}

TEST(Standstill, AHoleOfThreeSamplesIsBorneAndOneOfFourIsNot) {
    for (const std::uint64_t lost : {3U, 4U}) {
        Board board;
        EXPECT_EQ(board.first_stand(0, 60), 60U);
        EXPECT_EQ(board.first_stand(60 + lost, 400), lost == 3 ? 102U : 60 + lost + 102);
    }
}

TEST(Standstill, AtMoreThanTwoMillisecondsNoSampleMayBeLost) {
    for (const std::uint32_t sample_us : {2000U, 2500U}) {
        Board board;
        board.machine.can.sample_us = sample_us;
        board.rules = rules_of(board.machine);
        EXPECT_EQ(board.rules.gap_samples_max, sample_us == 2000 ? 4U : 1U);
        EXPECT_EQ(board.first_stand(0, 20), 20U);
        const std::uint64_t window = board.rules.window_samples;
        EXPECT_EQ(board.first_stand(21, 400), sample_us == 2000 ? window : 21 + window);
    }
}

TEST(Standstill, SixteenStridesOfASlowBoardCount) {
    Board board;
    board.machine.can.sample_us = 10'000;
    board.rules = rules_of(board.machine);
    EXPECT_EQ(board.rules.window_samples, 17U);  // 160 ms of at least 9.9
}

// 12 um of width, 0.1 mm/s: 240 ms.
TEST(Standstill, TheWindowIsLongEnoughForASlowAxis) {
    Board board;
    board.machine.axes[0].position_error = 0.005;
    board.rules = rules_of(board.machine);
    EXPECT_EQ(board.rules.window_samples, 243U);
    // 12 um, and again what two errors and roundings hide, and 4.04 ms and 20 us of 5 m/s2.
    EXPECT_NEAR(board.rules.true_width[0], 0.012 + 0.011 + 5000 * 4.06e-3 * 4.06e-3 / 8, 1e-9);
}

TEST(Standstill, OnlySamplesAfterTheStopCount) {
    Board board;
    begin_standstill(board.state, 300'000);
    EXPECT_EQ(board.first_stand(0, 1000), 403U);
    begin_standstill(board.state, 300'000);
    EXPECT_EQ(board.first_stand(1000, 2000), 1102U);
}

TEST(Standstill, AReceiverThatBeginsAnewBeginsAWindow) {
    Board board;
    EXPECT_EQ(board.first_stand(0, 200), 102U);
    EXPECT_FALSE(board.note(102));  // not newer
    EXPECT_EQ(board.first_stand(103, 400), 204U);
}

TEST(Standstill, AnOldStandstillIsNone) {
    Board board;
    EXPECT_EQ(board.first_stand(0, 200), 102U);
    EXPECT_TRUE(stands(board.state, board.rules, 102'000 + 3000));
    EXPECT_FALSE(stands(board.state, board.rules, 102'000 + 3001));
}

TEST(Standstill, AnEndlessAxisStandsAtTheSeamOfItsTurn) {
    Board board;
    std::uint64_t stood = 0;
    for (std::uint64_t k = 0; k < 400; ++k) {
        const double turning = k < 100 ? 0.03 * (static_cast<double>(k) - 100) : 0;
        const double noise = k % 2 == 0 ? 1e-5 : -1e-5;
        board.snapshot.position[4] = turning + noise + 2 * kPi * (turning + noise < 0 ? 1 : 0);
        stood += board.note(k) ? 1 : 0;
    }
    EXPECT_GT(stood, 180U);
    EXPECT_LE(stood, 198U);
}

TEST(Standstill, AWholeTurnBetweenTwoSamplesWouldLookLikeRest) {
    Machine machine = still_machine();
    for (const double speed : {1500.0, 1600.0}) {  // rad/s, over 4.06 ms: 6.1 and 6.5
        machine.axes[4].speed_max = speed;
        machine.axes[4].unlimited = true;
        EXPECT_EQ(rules_of(machine).window_samples == kNeverStands, speed > 1550);
        machine.axes[4].unlimited = false;
        EXPECT_NE(rules_of(machine).window_samples, kNeverStands);
    }
}

TEST(Standstill, PositionsThatAreNoNumbersAreNoStandstill) {
    Board board;
    board.snapshot.position[3] = std::nan("");
    EXPECT_EQ(board.first_stand(0, 400), 400U);
}

TEST(Standstill, ZeroedRulesNeverStand) {
    Board board;
    board.rules = {};
    EXPECT_EQ(board.first_stand(0, 400), 400U);
    board.rules = rules_of(board.machine);
    board.rules.window_samples = 0;
    EXPECT_EQ(board.first_stand(0, 400), 400U);
}

TEST(Standstill, FramesWithoutAModeNeedASecond) {
    Machine machine = five_axis_machine(CanFormat::signals);
    EXPECT_EQ(rules_of(machine).window_samples, 1011U);
    machine.can.signals.push_back(machine.can.signals[0]);
    machine.can.signals.back().role = SignalRole::moving;
    EXPECT_LT(rules_of(machine).window_samples, 110U);
}

// The speed of one drive says nothing about the others.
TEST(Standstill, DrivesStandOnlyWhereAllReportTheirSpeed) {
    Machine machine = five_axis_machine(CanFormat::cia402);
    EXPECT_EQ(rules_of(machine).window_samples, kNeverStands);
    for (std::uint32_t i = 1; i < 5; ++i) {
        CanSignal velocity = machine.can.signals[0];
        velocity.role = SignalRole::velocity;
        velocity.axis = i;
        machine.can.signals.push_back(velocity);
    }
    EXPECT_LT(rules_of(machine).window_samples, 110U);
}

}  // namespace
}  // namespace axg
