// SPDX-License-Identifier: Apache-2.0
// What confirms a stop, and what a reset and an arming need: every axis stands, by all frames of a
// window. In each format a machine moves whose frames say as much of standstill as they can.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/support/live_world.hpp"

namespace axg {
namespace {

using test::LiveWorld;

struct Format {
    const char* name;
    CanFormat format;
    bool has_moving_signal = false;
};

/// Of drives each sends its speed with its position; of signals one frame may say "moving".
Machine machine_of(const Format& format) {
    Machine machine = test::five_axis_machine(format.format);
    if (format.has_moving_signal) {
        CanSignal moving = machine.can.signals.back();
        moving.role = SignalRole::moving;
        moving.order = ByteOrder::little;
        moving.start_bit = 40;
        moving.length_bits = 1;
        moving.is_signed = false;
        moving.mark = 1;
        machine.can.signals.push_back(moving);
    }
    if (format.format == CanFormat::cia402) {
        for (CanSignal& signal : machine.can.signals) {
            signal.frame_bytes = signal.id < 0x200 && signal.axis != 0 ? 8 : signal.frame_bytes;
        }
        for (std::uint32_t axis = 1; axis < 5; ++axis) {
            CanSignal speed = machine.can.signals.back();
            speed.id = 0x183 + axis;
            speed.axis = axis;
            speed.start_bit = 48;
            speed.length_bits = 16;
            speed.frame_bytes = 8;
            speed.factor = 0.02;
            machine.can.signals.push_back(speed);
        }
    }
    return machine;
}

class GuardStandstill : public testing::TestWithParam<Format> {
  protected:
    GuardStandstill() {
        world.says = [this](AxisSnapshot& snapshot) {
            snapshot.mode = kModeStandstill;
            snapshot.position = {10, 20, -30, 0.5, 0.25};
            const double t_s = static_cast<double>(snapshot.latched_us) * 1e-6;
            moves(snapshot, t_s);
        };
    }
    /// An armed guard, its motion only supposed to be armed, then stopped.
    void stop() {
        world.run_periods(40);
        world.guard->arm(world.wire.now_us);
        world.run_periods(20);
        ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
        world.guard->report(GuardFault::refused, world.wire.now_us);
        ASSERT_EQ(guard().phase, GuardPhase::stopped);
    }
    /// As deployed: a person arms, or nobody.
    void deploy() {
        world.options = {};
        world.start();
    }
    /// The newest refusal of a person's reset or arming.
    std::string refusal() {
        std::string words;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            words = note.kind == LiveNote::Kind::refused ? note.words : words;
        }
        return words;
    }
    /// The axes of which a note says that they move, since the last look.
    std::vector<std::uint32_t> motions() {
        std::vector<std::uint32_t> axes;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            if (note.kind == LiveNote::Kind::motion) {
                axes.push_back(note.axis);
            }
        }
        return axes;
    }
    /// A mode, or a signal, without any speed: it may say "at rest" of an axis that moves.
    static bool says_it_stands() {
        return GetParam().format != CanFormat::cia402 &&
               (GetParam().format != CanFormat::signals || GetParam().has_moving_signal);
    }
    /// Periods until it is so, at most `periods_max`.
    template <class Condition>
    std::int64_t periods_until(std::int64_t periods_max, const Condition& is_so) {
        for (std::int64_t period = 0; period < periods_max; ++period) {
            if (is_so()) {
                return period;
            }
            world.run_periods(1);
        }
        return periods_max;
    }
    void expect_unconfirmed(std::int64_t periods) {
        const std::int64_t from_us = world.wire.now_us;
        EXPECT_EQ(periods_until(periods, [&] { return guard().is_confirmed; }), periods);
        EXPECT_GE(world.count_sent(world.machine.can.stop_id, from_us),
                  static_cast<std::size_t>(periods - 2))
            << "one a period";
        refusal();
        world.guard->reset(world.wire.now_us);
        EXPECT_EQ(refusal(), "reset: the axes are not yet at rest");
        EXPECT_EQ(guard().phase, GuardPhase::stopped);
    }
    const Guard& guard() const { return world.guard->guard(); }
    /// Frames without a mode need a second.
    std::int64_t window_periods() const {
        return GetParam().format == CanFormat::signals && !GetParam().has_moving_signal ? 1000
                                                                                        : 100;
    }
    /// Of rest, and the axes stand: the window, a part of it and what the receiver needs.
    std::int64_t rest_periods() const { return window_periods() == 100 ? 150 : 1100; }
    double now_s() const { return static_cast<double>(world.wire.now_us) * 1e-6; }
    /// X at up to 125 mm/s, until it rests where it is.
    void swing() {
        moves = [this](AxisSnapshot& snapshot, double t_s) {
            snapshot.position[0] += 5 * std::sin(25 * std::min(t_s, rests_from_s));
        };
    }

    double rests_from_s = std::numeric_limits<double>::infinity();
    std::function<void(AxisSnapshot&, double t_s)> moves = [](AxisSnapshot&, double) {};
    LatchCell latch{kLatchClear, ~kLatchClear};
    LiveWorld world{machine_of(GetParam()), latch};
};

TEST_P(GuardStandstill, OneAxisThatMovesBesideOthersAtRestConfirmsNothing) {
    for (std::uint32_t axis = 0; axis < 5; ++axis) {
        SCOPED_TRACE(axis);
        const double from_s = now_s();
        moves = [axis, from_s](AxisSnapshot& snapshot, double t_s) {
            snapshot.position[axis] += (axis < 3 ? 20 : 0.2) * std::max(0.0, t_s - from_s);
        };
        world.run_periods(2);  // the axis before is where it was
        set_latch(latch, false);
        world.start();
        stop();
        expect_unconfirmed(rest_periods() + 100);
    }
}

TEST_P(GuardStandstill, AnAxisThatSwingsUnderModeZeroIsNeitherConfirmedNorResetNorArmed) {
    swing();
    stop();
    expect_unconfirmed(rest_periods() + 100);
    set_latch(latch, false);
    deploy();
    world.run_periods(2 * rest_periods());
    // Signals say nothing of motion and drives say that X moves; the others contradict themselves.
    const GuardPhase phase = says_it_stands() ? GuardPhase::selftest : GuardPhase::ready;
    ASSERT_EQ(guard().phase, phase) << to_text(guard().cause);
    const std::int64_t from_us = world.wire.now_us;
    refusal();
    world.guard->arm(from_us);
    EXPECT_EQ(refusal(),
              says_it_stands() ? "arm: the guard is not ready" : "arm: the axes are not at rest");
    world.run_periods(25);
    EXPECT_EQ(guard().phase, phase);
    EXPECT_EQ(world.count_sent(world.machine.can.permit_id, from_us), 0U);
}

TEST_P(GuardStandstill, AnAxisThatMovesUnderModeZeroKeepsTheGuardFromBeingReady) {
    deploy();
    world.run_periods(2 * rest_periods() + 600);  // until the period is shown, too
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    motions();
    const double from_s = now_s();
    moves = [&](AxisSnapshot& snapshot, double t_s) {  // 2 mm/s for a while, then rest
        snapshot.position[2] -= 2 * std::clamp(t_s - from_s, 0.0, rests_from_s - from_s);
    };
    world.run_periods(60);
    EXPECT_EQ(guard().phase, says_it_stands() ? GuardPhase::selftest : GuardPhase::ready);
    EXPECT_EQ(motions(), std::vector<std::uint32_t>(says_it_stands() ? 1 : 0, 2U))
        << "said once, with its axis";
    rests_from_s = now_s();
    world.run_periods(rest_periods() + 40);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_TRUE(motions().empty());
}

// A jog moves under a mode of its own: nothing contradicts it, nor the rest that follows.
TEST_P(GuardStandstill, AJogIsNoContradiction) {
    if (GetParam().format != CanFormat::classical && GetParam().format != CanFormat::fd) {
        return;  // no such mode in these formats
    }
    const double from_s = now_s() + 0.3;
    rests_from_s = from_s + 0.5;
    moves = [&](AxisSnapshot& snapshot, double t_s) {
        snapshot.position[0] += 2 * std::clamp(t_s - from_s, 0.0, rests_from_s - from_s);
        snapshot.mode = t_s >= from_s && t_s < rests_from_s ? kModeJog : kModeStandstill;
    };
    deploy();
    world.run_periods(1200);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_TRUE(motions().empty());
}

TEST_P(GuardStandstill, AMachineAtRestIsConfirmedInTimeResetAndArmed) {
    swing();
    deploy();
    world.run_periods(40);
    world.guard->report(GuardFault::refused, world.wire.now_us);
    world.run_periods(40);
    rests_from_s = now_s();
    const std::int64_t periods =
        periods_until(rest_periods(), [&] { return guard().is_confirmed; });
    EXPECT_GE(periods, window_periods());
    EXPECT_LT(periods, rest_periods()) << "not confirmed";
    const std::int64_t confirmed_us = world.wire.now_us;
    world.run_periods(20);
    EXPECT_LE(world.count_sent(world.machine.can.stop_id, confirmed_us), 1U);
    world.guard->reset(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::selftest) << refusal();
    world.run_periods(600);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    world.guard->arm(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << refusal();
}

TEST_P(GuardStandstill, AMachineThatStoodBeforeTheStopIsWatchedAnew) {
    world.run_periods(rest_periods());
    stop();
    const std::int64_t periods =
        periods_until(rest_periods(), [&] { return guard().is_confirmed; });
    EXPECT_GE(periods, window_periods());
    EXPECT_LT(periods, rest_periods());
}

TEST_P(GuardStandstill, AnAxisThatMovesAgainIsStoppedAgain) {
    stop();
    ASSERT_LT(periods_until(rest_periods(), [&] { return guard().is_confirmed; }), rest_periods());
    moves = [from_s = now_s()](AxisSnapshot& snapshot,
                               double t_s) {  // as a load that sinks, 2 mm/s
        snapshot.position[2] -= 2 * std::max(0.0, t_s - from_s);
    };
    EXPECT_LT(periods_until(20, [&] { return !guard().is_confirmed; }), 20);
    expect_unconfirmed(rest_periods());
}

TEST_P(GuardStandstill, ABoardThatFallsSilentIsStoppedAgain) {
    stop();
    ASSERT_LT(periods_until(rest_periods(), [&] { return guard().is_confirmed; }), rest_periods());
    world.passes = [](const CanFrame&) { return false; };
    EXPECT_LT(periods_until(10, [&] { return !guard().is_confirmed; }), 10);
    expect_unconfirmed(20);
    world.passes = [](const CanFrame&) { return true; };
    EXPECT_LT(periods_until(rest_periods(), [&] { return guard().is_confirmed; }), rest_periods())
        << "the guard's own receiver has given up, and the machine stands all the same";
}

// Replays suppose that a person has armed what moves; so do these tests.
TEST_P(GuardStandstill, AMotionIsArmedWhereThatIsOnlySupposed) {
    swing();
    world.run_periods(40);
    world.guard->arm(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::armed);
    EXPECT_FALSE(LiveOptions{}.supposes_arming);
    EXPECT_FALSE(LiveOptions{}.ignores_period);
}

INSTANTIATE_TEST_SUITE_P(Formats, GuardStandstill,
                         testing::Values(Format{"classical", CanFormat::classical},
                                         Format{"fd", CanFormat::fd},
                                         Format{"signals", CanFormat::signals},
                                         Format{"dbc", CanFormat::signals, true},
                                         Format{"cia402", CanFormat::cia402}),
                         [](const auto& tested) { return tested.param.name; });

// One speed of five: nothing says that the others rest.
TEST(GuardStandstillOfDrives, AStatusWordWithoutASpeedConfirmsNothing) {
    LatchCell latch;  // of an earlier run
    LiveWorld world(test::five_axis_machine(CanFormat::cia402), latch);
    world.stands_still = true;
    world.run_periods(3000);
    EXPECT_FALSE(world.guard->guard().is_confirmed);
    EXPECT_GE(world.count_sent(world.machine.can.stop_id), 2998U);
}

}  // namespace
}  // namespace axg
