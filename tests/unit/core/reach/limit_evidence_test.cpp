// SPDX-License-Identifier: Apache-2.0
// Broken limits by hand, each from both sides: what errors explain is no evidence, more is; a stop
// of the board's own is borne as long as it is one.
#include "core/reach/limit_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/sincos.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "tests/support/can_board.hpp"

namespace axg {
namespace {

using namespace test;

constexpr double kErrorMm = 0.002;

/// The paper's machine in small: one axis, samples of 1 ms, no jitter, errors of 2 um.
Machine one_axis() {
    Machine machine;
    Axis axis;
    axis.name = "X";
    axis.min = -1000;
    axis.max = 1000;
    axis.speed_max = 500;
    axis.acceleration_max = 4000;
    axis.jerk_max = 50'000;
    axis.stopping_min = 3500;
    axis.position_error = kErrorMm;
    machine.axes.push_back(axis);
    machine.guard.latch_jitter_s = 0;
    return machine;
}

struct Board {
    Machine machine;
    LimitRules rules;
    LimitWatch watch;
    MotionHistory history;

    explicit Board(Machine of = one_axis()) : machine(std::move(of)) {
        constexpr std::array<double, 1> kCount{0};
        rules = limit_rules(machine, kCount);
    }
    LimitFact note(std::uint64_t sample, double position) {
        AxisSnapshot snapshot;
        snapshot.sample = sample;
        snapshot.axis_count = 1;
        snapshot.position[0] = position;
        note_snapshot(history, snapshot, rules.stride);
        return note_limits(watch, rules, snapshot, history);
    }
    /// The first fact of a motion, by the sample; none by `end`.
    LimitFact first_fact(std::uint64_t end, const std::function<double(double)>& position_at) {
        for (std::uint64_t k = 0; k < end; ++k) {
            const LimitFact fact =
                note(1000 + k, position_at(static_cast<double>(k) * rules.axes[0].errors.period_s));
            if (fact.kind != LimitKind::none) {
                return fact;
            }
        }
        return {};
    }
};

TEST(LimitEvidence, SpeedIsMeasuredOnBothSides) {
    for (const double speed : {504.9, 507.0}) {  // 1 % of the period, and 4 um in 8 ms
        Board board;
        const LimitFact fact = board.first_fact(40, [&](double t) { return speed * t; });
        EXPECT_EQ(fact.kind, speed < 505 ? LimitKind::none : LimitKind::speed);
        if (fact.kind != LimitKind::none) {
            EXPECT_EQ(fact.axis, 0U);
            EXPECT_EQ(fact.declared, 500);
            EXPECT_GT(fact.measured, 500);
            EXPECT_LT(fact.measured, speed);
        }
    }
}

TEST(LimitEvidence, ATenthMoreAccelerationOver16MsIsFound) {
    for (const double share : {1.0, 1.1}) {
        Board board;
        const LimitFact fact = board.first_fact(21, [&](double t) {
            const double during = std::min(t, 16e-3), after = t - during;
            return 0.5 * share * 4000 * during * during + share * 4000 * during * after;
        });
        EXPECT_EQ(fact.kind, share == 1.0 ? LimitKind::none : LimitKind::acceleration);
        if (share > 1) {
            EXPECT_LE(fact.sample, 1020U);
            EXPECT_GT(fact.measured, 4000);
            EXPECT_LT(fact.measured, 4400);
        }
    }
}

TEST(LimitEvidence, FiveTimesTheAccelerationIsFoundInThreeSamples) {
    Board board;
    const LimitFact fact = board.first_fact(20, [](double t) { return 10'000 * t * t; });
    EXPECT_EQ(fact.kind, LimitKind::acceleration);
    EXPECT_LE(fact.sample, 1003U);
}

// 0.4 mm in 1 ms keeps the largest speed and takes a hundred times the acceleration.
TEST(LimitEvidence, AStepFromRestToRestIsFound) {
    for (const double way : {1.0, -1.0}) {
        Board board;
        const LimitFact fact =
            board.first_fact(200, [&](double t) { return t < 0.0995 ? 0.0 : 0.4 * way; });
        EXPECT_EQ(fact.kind, LimitKind::acceleration);
        EXPECT_EQ(fact.sample, 1100U);
        EXPECT_GT(fact.measured, 90'000);
    }
}

/// From rest at 0.1 s: jerk up to the acceleration, then that; stands still from `freezes_s` on.
double launched(double t, double jerk, double acceleration, double freezes_s) {
    const double s = std::clamp(t, 0.1, freezes_s) - 0.1;
    const double ramp = acceleration / jerk, rising = std::min(s, ramp), after = s - rising;
    const double speed = 0.5 * jerk * rising * rising;
    return jerk * rising * rising * rising / 6 + speed * after + 0.5 * acceleration * after * after;
}

/// From rest to rest: full acceleration at once, then as much the other way.
double there_at_once(double t, double half_s) {
    const double s = std::clamp(t - 0.1, 0.0, 2 * half_s);
    const double rising = std::min(s, half_s), after = s - rising;
    return 2000 * (rising * rising - after * after) + 4000 * rising * after;
}

// An axis that rested has nothing to brake: too fast a start is no stop of the board's own,
// whatever the first samples look like. A start that keeps its jerk and is stopped at once stays
// one.
TEST(LimitEvidence, AStartFromRestIsNoStop) {
    Machine machine = one_axis();
    machine.guard.free_jerk_limited = true;
    for (const double factor : {2.0, 4.0, 10.0, 100.0}) {
        Board board(machine);
        const LimitFact fact =
            board.first_fact(160, [&](double t) { return launched(t, factor * 50'000, 4000, 1); });
        EXPECT_NE(fact.kind, LimitKind::none) << factor;
        EXPECT_LE(fact.sample, 1000U + 100U + 45U) << factor;
    }
    for (const double half_s : {0.02, 0.03, 0.06}) {
        Board board(machine);
        const LimitFact fact =
            board.first_fact(400, [&](double t) { return there_at_once(t, half_s); });
        EXPECT_NE(fact.kind, LimitKind::none) << half_s;
        EXPECT_LE(fact.sample, 1000U + 100U + 45U) << half_s;
    }
    for (int stop_ms = 1; stop_ms < 100; ++stop_ms) {
        Board board(machine);
        const LimitFact fact = board.first_fact(
            400, [&](double t) { return launched(t, 50'000, 4000, 0.1 + stop_ms * 1e-3); });
        EXPECT_EQ(fact.kind, LimitKind::none) << "stopped after " << stop_ms << " ms";
    }
}

TEST(LimitEvidence, JerkCountsWhereItIsPromisedInFreeMotion) {
    for (const bool is_limited : {false, true}) {
        for (const double share : {1.0, 2.0}) {
            Machine machine = one_axis();
            machine.guard.free_jerk_limited = is_limited;
            Board board(machine);
            const LimitFact fact = board.first_fact(
                35, [&](double t) { return 100 * t + share * 50'000 * t * t * t / 6; });
            EXPECT_EQ(fact.kind, is_limited && share > 1 ? LimitKind::jerk : LimitKind::none);
        }
    }
}

/// Motion at 300 mm/s to 0.1 s, then a stop of the board's own; or only down to `rest_speed`.
double stopped_at(double t, double deceleration, double rest_speed) {
    AxisMotion axis{.speed = 300};
    const double free = std::min(t, 0.1003);
    axis = moved_on(axis, free);
    AxisMotion slower{.position = axis.position, .speed = axis.speed - rest_speed};
    brake(slower, {.deceleration = deceleration, .jerk = 1e7}, t - free);
    return slower.position + rest_speed * (t - free);
}

TEST(LimitEvidence, AStopOfTheBoardsOwnMayBeHarder) {
    for (const bool is_limited : {false, true}) {
        Machine machine = one_axis();
        machine.guard.free_jerk_limited = is_limited;
        Board board(machine);
        bool held = true;
        for (std::uint64_t k = 0; k < 400; ++k) {
            const double t = static_cast<double>(k) * 1e-3;
            EXPECT_EQ(board.note(k, stopped_at(t, 12'000, 0)).kind, LimitKind::none) << k;
            // It rests from 126 ms on; nothing of before is believed until that is over.
            const bool holds = ranges_hold(board.watch, board.rules, board.history, 0);
            held = held && (holds || k < 103);
            EXPECT_TRUE(holds || (k > 100 && k < 146)) << k;
            EXPECT_FALSE(holds && k > 103 && k < 141) << k;
        }
        EXPECT_FALSE(held);
    }
}

// A period that is 1 % longer is no broken limit, however exact the positions are.
TEST(LimitEvidence, EveryLimitMayBeUsedUpAtTheLongestPeriod) {
    Machine machine = one_axis();
    machine.axes[0].position_error = 0;
    machine.guard.free_jerk_limited = true;
    const auto longest = [](double t) { return 1.0099 * t; };
    Board fast(machine), hard(machine), jerky(machine);
    EXPECT_EQ(fast.first_fact(60, [&](double t) { return 500 * longest(t); }).kind,
              LimitKind::none);
    EXPECT_EQ(hard.first_fact(60, [&](double t) { return 2000 * longest(t) * longest(t); }).kind,
              LimitKind::none);
    EXPECT_EQ(
        jerky
            .first_fact(60,
                        [&](double t) { return 50'000 * longest(t) * longest(t) * longest(t) / 6; })
            .kind,
        LimitKind::none);
}

// Sixteen strides of rest are kept, and differences that reach back into the stop are none of ours.
TEST(LimitEvidence, AnAxisMayMoveSixteenStridesAfterAStopOfTheBoardsOwn) {
    Machine machine = one_axis();
    machine.axes[0].position_error = 0;
    machine.guard.free_jerk_limited = true;
    Board board(machine);
    const LimitFact fact = board.first_fact(330, [](double t) {
        const double since = std::max(0.0, t - 0.143), ramp = std::min(since, 40e-3);
        const double on = since - ramp;
        return stopped_at(t, 12'000, 0) + 50'000 * ramp * ramp * ramp / 6 + (40 + 1000 * on) * on;
    });
    EXPECT_EQ(fact.kind, LimitKind::none) << fact.sample;
    EXPECT_TRUE(ranges_hold(board.watch, board.rules, board.history, 0));
}

TEST(LimitEvidence, ASampleThatIsOlderBeginsAnew) {
    Board board;
    for (std::uint64_t k = 0; k < 110; ++k) {
        (void)board.note(1000 + k, stopped_at(static_cast<double>(k) * 1e-3, 12'000, 0));
    }
    EXPECT_TRUE(board.watch.stops[0].is_on);
    EXPECT_EQ(board.note(50, 0).kind, LimitKind::none);
    EXPECT_FALSE(board.watch.stops[0].is_on);
}

// The same change of speed without rest after it is a broken limit, told when rest is overdue.
TEST(LimitEvidence, AStopThatDoesNotEndAtRestIsFound) {
    Board board;
    const LimitFact fact =
        board.first_fact(600, [](double t) { return stopped_at(t, 12'000, 100); });
    EXPECT_EQ(fact.kind, LimitKind::acceleration);
    EXPECT_GT(fact.measured, 4000);
    EXPECT_LT(fact.sample, 1101 + board.rules.axes[0].stop_strides + 20);
}

TEST(LimitEvidence, AnAxisThatIsFasterAgainAfterAStopBeganIsFound) {
    Board board;
    const LimitFact fact = board.first_fact(600, [](double t) {
        const double again = std::max(0.0, t - 0.115);
        return stopped_at(t, 12'000, 50) + 0.5 * 3000 * again * again;
    });
    EXPECT_EQ(fact.kind, LimitKind::acceleration);
    EXPECT_LT(fact.sample, 1125U);
}

TEST(LimitEvidence, TheSpeedIsNoMatterOfStops) {
    Board board;
    const LimitFact fact = board.first_fact(
        600, [](double t) { return t < 0.1 ? 520 * t : 52 + stopped_at(t, 12'000, 0); });
    EXPECT_EQ(fact.kind, LimitKind::speed);
}

TEST(LimitEvidence, WithoutStopsOfTheBoardsOwnNoneIsExcused) {
    Board board;
    board.rules.axes[0].stop_strides = 0;
    const LimitFact fact = board.first_fact(400, [](double t) { return stopped_at(t, 12'000, 0); });
    EXPECT_EQ(fact.kind, LimitKind::acceleration);
}

// Strides of 3 and 5 samples are no differences of ours: the ranges see them.
TEST(LimitEvidence, RangesThatContradictEachOtherAreAFact) {
    Board board;
    board.rules.axes[0].stop_strides = 0;
    board.rules.weights = {.speed = 1e6, .acceleration = 1e6, .jerk = 1e6};
    const LimitFact fact = board.first_fact(400, [](double t) { return stopped_at(t, 12'000, 0); });
    EXPECT_EQ(fact.kind, LimitKind::speed_range);
    EXPECT_GT(fact.measured, 0);
    Board excused;
    excused.rules.weights = board.rules.weights;
    EXPECT_EQ(excused.first_fact(400, [](double t) { return stopped_at(t, 12'000, 0); }).kind,
              LimitKind::none);
    Board faster;
    faster.rules.weights = board.rules.weights;
    EXPECT_NE(faster.first_fact(400, [](double t) { return 10'000 * t * t; }).kind,
              LimitKind::none);
}

// In a stop of its own an axis gets no farther than its last believed state could lead it, and the
// errors of two positions. Only the ranges judge here: from rest, in 17 ms, free motion leads 0.31
// mm.
TEST(LimitEvidence, AStopOfTheBoardsOwnGetsNoFartherThanTheLastBelievedStateLeads) {
    Machine machine = one_axis();
    machine.axes[0].position_error = 0.01;
    machine.guard.free_jerk_limited = true;
    for (const double way : {1.0, -1.0}) {
        for (const double moved : {0.30, 0.36}) {
            Board board(machine);
            board.rules.weights = {.speed = 1e6, .acceleration = 1e6, .jerk = 1e6};
            const LimitFact fact =
                board.first_fact(200, [&](double t) { return t < 0.0995 ? 0.0 : way * moved; });
            EXPECT_EQ(fact.kind, moved < 0.31 ? LimitKind::none : LimitKind::speed_range) << moved;
        }
    }
}

// Half a turn between two points, and the short way round may be the wrong one.
TEST(LimitEvidence, AnEndlessAxisIsFollowedAcrossTheTurn) {
    Machine machine = one_axis();
    Axis& axis = machine.axes[0];
    axis.unlimited = true;
    axis.kind = AxisKind::rotary;
    axis.speed_max = 1000;  // rad/s: 4 ms are more than half a turn
    axis.acceleration_max = 20'000;
    axis.position_error = 1e-5;
    const auto turned = [](double way) { return way - 2 * kPi * std::floor(way / (2 * kPi)); };
    for (const double share : {1.0, 1.2}) {
        Board board(machine);
        const LimitFact fact =
            board.first_fact(40, [&](double t) { return turned(0.5 * share * 20'000 * t * t); });
        EXPECT_EQ(fact.kind, share > 1 ? LimitKind::acceleration : LimitKind::none);
    }
}

TEST(LimitEvidence, PointsThatAreNotEvenlySpacedAreNotCompared) {
    Board board;
    for (std::uint64_t k = 0; k < 120; ++k) {
        const double t = static_cast<double>(k) * 1e-3;
        if (k % 3 != 1) {
            EXPECT_EQ(board.note(k, 2000 * t * t).kind, LimitKind::none) << k;
        }
    }
}

TEST(LimitEvidence, SamplesOfATenthOfAMillisecondAreTenToAStride) {
    Machine machine = one_axis();
    machine.can.sample_us = 100;
    Board board(machine);
    EXPECT_EQ(board.rules.stride, 10U);
    const LimitFact fact = board.first_fact(200, [](double t) { return 10'000 * t * t; });
    EXPECT_EQ(fact.kind, LimitKind::acceleration);
    EXPECT_LE(fact.sample, 1030U);
}

TEST(LimitEvidence, AReceiverThatBeginsAnewBeginsAWindow) {
    Board board;
    EXPECT_EQ(board.note(100, 0).kind, LimitKind::none);
    EXPECT_EQ(board.note(101, 0).kind, LimitKind::none);
    forget_limits(board.watch);
    EXPECT_EQ(board.note(102, 0.4).kind, LimitKind::none);
    EXPECT_EQ(board.note(103, 0.4).kind, LimitKind::none);
}

TEST(LimitEvidence, TheFiguresAreTheLeastThatExplainsThePoints) {
    Board board;
    for (std::uint64_t k = 0; k < 30; ++k) {
        const double t = static_cast<double>(k) * 1e-3;
        (void)board.note(k, 100 * t + 1500 * t * t);
    }
    const LimitFigures figures = measure_limits(board.watch, board.rules, 0);
    EXPECT_GT(figures.speed, 170);
    EXPECT_LT(figures.speed, 100 + 3000 * 0.029);
    EXPECT_GT(figures.acceleration, 2700);
    EXPECT_LT(figures.acceleration, 3000);
    EXPECT_EQ(figures.jerk, 0);
}

// From full acceleration: 80 ms until it is none, 70 to the guaranteed deceleration, 143 at it.
TEST(LimitEvidence, AStopMayLastAsLongAsTheSoftestOne) {
    const Board board;
    EXPECT_NEAR(static_cast<double>(board.rules.axes[0].stop_strides), 293 / 0.99, 3);
    EXPECT_NEAR(static_cast<double>(board.rules.axes[0].ramp_strides), 80 / 0.99, 3);
}

TEST(LimitEvidence, WithoutALimitOfJerkAStopLastsAsLongAsBrakingAlone) {
    Machine machine = one_axis();
    machine.axes[0].jerk_max = kNoJerkLimit;
    const Board board(machine);
    EXPECT_NEAR(static_cast<double>(board.rules.axes[0].stop_strides), 500.0 / 3.5 / 0.99, 2);
    EXPECT_LE(board.rules.axes[0].ramp_strides, 2U);
}

/// Two axes: X as in one_axis, and Y as it.
struct TwoAxes {
    Machine machine = one_axis();
    LimitRules rules;
    LimitWatch watch;
    MotionHistory history;
    LimitFact fact;
    std::uint64_t found = 0, began = 0, ended = 0;  // samples; 0: never

    TwoAxes() {
        machine.axes.push_back(machine.axes[0]);
        machine.axes[1].name = "Y";
    }
    void watch_until(std::uint64_t end, const std::function<double(double)>& x,
                     const std::function<double(double)>& y) {
        constexpr std::array<double, 2> kCount{0, 0};
        rules = limit_rules(machine, kCount);
        for (std::uint64_t k = 0; k < end && fact.kind == LimitKind::none; ++k) {
            AxisSnapshot snapshot;
            snapshot.sample = k;
            snapshot.axis_count = 2;
            const double t = static_cast<double>(k) * 1e-3;
            snapshot.position[0] = x(t);
            snapshot.position[1] = y(t);
            note_snapshot(history, snapshot, rules.stride);
            fact = note_limits(watch, rules, snapshot, history);
            found = fact.kind == LimitKind::none ? 0 : k;
            began = began == 0 && watch.machine_stop.is_on ? k : began;
            ended = began != 0 && ended == 0 && !watch.machine_stop.is_on ? k : ended;
        }
    }
    [[nodiscard]] std::uint64_t longest_stop() const {
        return rules.machine_stop.braking_strides + rules.machine_stop.reaction_strides;
    }
};

double frozen_at(double t, double speed, double freezes_s) {
    return speed * std::min(t, freezes_s);
}

// The count of X repeats while Y goes on: a stop of the board's own at once, and a broken limit as
// soon as the slowest axis would have come to rest.
TEST(LimitEvidence, OneFrozenAxisIsNoStopOfTheBoard) {
    TwoAxes axes;
    axes.watch_until(
        1000, [](double t) { return frozen_at(t, 100, 0.1); }, [](double t) { return 50 * t; });
    EXPECT_EQ(axes.began, 101U) << "at the first count that is repeated";
    EXPECT_EQ(axes.fact.kind, LimitKind::frozen_axis);
    EXPECT_EQ(axes.fact.axis, 0U);
    EXPECT_NEAR(axes.fact.measured, 95, 5);
    EXPECT_EQ(axes.found, axes.began + axes.longest_stop() + 17);
    EXPECT_STREQ(to_text(axes.fact.kind), "frozen_axis");
}

// A board that promises nothing of its stops as a whole: each axis may stop by itself.
TEST(LimitEvidence, WithoutABoardsContractOneAxisMayStopByItself) {
    TwoAxes axes;
    axes.machine.can.format = CanFormat::cia402;
    axes.watch_until(
        1000, [](double t) { return frozen_at(t, 100, 0.1); }, [](double t) { return 50 * t; });
    EXPECT_EQ(axes.fact.kind, LimitKind::none);
    EXPECT_EQ(axes.began, 101U);
    EXPECT_GT(axes.ended, 101U);
}

// Both commands freeze, as in an emergency stop of LinuxCNC: one brakes harder than it can, both
// rest.
TEST(LimitEvidence, AllAxesMayStopAtOnce) {
    TwoAxes axes;
    axes.machine.axes[0].stopping_most = axes.machine.axes[1].stopping_most = 8000;
    axes.watch_until(
        1000, [](double t) { return frozen_at(t, 100, 0.1); },
        [](double t) { return frozen_at(t, 50, 0.11); });
    EXPECT_EQ(axes.fact.kind, LimitKind::none);
    EXPECT_EQ(axes.began, 101U);
    EXPECT_NEAR(static_cast<double>(axes.ended), 110 + 12, 2);
}

// Harder than the drive can brake, and another axis brakes as drives do: told without waiting for
// the softest stop.
TEST(LimitEvidence, AHarderStopThanAnyOfTheDriveIsNone) {
    const auto soft = [](double t) {
        AxisMotion axis{.speed = 300};
        const double free = std::min(t, 0.1);
        axis = moved_on(axis, free);
        brake(axis, {.deceleration = 3500, .jerk = 1e7}, t - free);
        return axis.position;
    };
    for (const double most : {8000.0, 1e9}) {
        TwoAxes axes;
        axes.machine.axes[0].stopping_most = most;
        axes.watch_until(
            1000, [](double t) { return frozen_at(t, 100, 0.1); }, soft);
        EXPECT_EQ(axes.fact.kind, most < 1e9 ? LimitKind::stopping : LimitKind::none);
        if (most < 1e9) {
            EXPECT_EQ(axes.found, axes.began + axes.rules.machine_stop.reaction_strides + 17);
            EXPECT_EQ(axes.fact.declared, 8000);
            EXPECT_STREQ(to_text(axes.fact.kind), "stopping");
        }
    }
}

// Above the speed that check prints every freeze is found within the longest strides.
TEST(LimitEvidence, AFreezeAboveTheBlindSpeedIsFound) {
    TwoAxes tried;
    tried.watch_until(
        1, [](double) { return 0.0; }, [](double) { return 0.0; });
    const double blind = blind_speed(tried.rules, 0);
    EXPECT_GT(blind, 4);
    EXPECT_LT(blind, 20);
    for (int i = 0; i < 50; ++i) {
        const double speed = blind * (1.01 + 0.5 * i), freezes_s = 0.1 + i * 17e-5;
        TwoAxes axes;
        axes.watch_until(
            200, [=](double t) { return frozen_at(t, speed, freezes_s); },
            [](double t) { return 50 * t; });
        EXPECT_GE(axes.began, 100U) << speed;
        EXPECT_LE(axes.began, 100U + 18U) << speed;
    }
    TwoAxes slow;  // it may have stopped within its acceleration
    slow.watch_until(
        200, [=](double t) { return frozen_at(t, 0.5 * std::sqrt(4000 * 4 * kErrorMm), 0.1); },
        [](double t) { return 50 * t; });
    EXPECT_EQ(slow.began, 0U);
}

TEST(LimitEvidence, AnEndlessAxisThatMayTurnHalfRoundIsNeverSeenToFreeze) {
    Machine machine = one_axis();
    machine.axes[0].unlimited = true;
    machine.axes[0].kind = AxisKind::rotary;
    machine.axes[0].speed_max = 4000;
    constexpr std::array<double, 1> kCount{0};
    EXPECT_EQ(blind_speed(limit_rules(machine, kCount), 0), INFINITY);
}

TEST(LimitEvidence, EachKindHasAName) {
    for (const LimitKind kind :
         {LimitKind::none, LimitKind::speed, LimitKind::acceleration, LimitKind::jerk,
          LimitKind::speed_range, LimitKind::frozen_axis, LimitKind::stopping}) {
        EXPECT_STRNE(to_text(kind), to_text(LimitKind::acceleration_range));
    }
}

}  // namespace
}  // namespace axg
