// SPDX-License-Identifier: Apache-2.0
// Emergency stops of the simulated board, each axis by itself or along a curved path, harder than
// free motion and at any moment of it, some of which turn an axis round: the guard that watches the
// frames sees no broken limit. Watched by wrong rules, made here, such stops are. AXG_COUNT: stops
// of each kind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "core/certificate/stop_certificate.hpp"
#include "core/reach/limit_evidence.hpp"
#include "core/reach/look_ahead_path.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "tests/support/between.hpp"
#include "tests/support/count.hpp"
#include "tests/support/look_ahead_machine.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/permit_guard.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

struct StopCase {
    Machine machine;
    std::uint64_t motion_seed = 0;
    std::array<double, kAxesMax> start{};
    BoardOptions board;
    std::uint64_t stop_at = 0;  // sample
};

StopCase random_stop_case(Random& random, StopPromise promise) {
    StopCase c;
    c.machine = motion_test_machine();
    for (Axis& axis : c.machine.axes) {
        const double unit = axis.kind == AxisKind::rotary ? 0.01 : 1;
        axis.speed_max = between(random, 50, 1000) * unit;
        axis.acceleration_max = between(random, 1000, 10000) * unit;
        axis.jerk_max = between(random, 2e4, 2e5) * unit;
        axis.stopping_min = axis.acceleration_max * between(random, 0.5, 1);
        axis.position_error = 0;  // what the frames round is in its count
    }
    c.machine.guard.free_jerk_limited = random() % 2 == 0;
    c.machine.guard.stop_reversal =
        random() % 2 == 0 ? StopReversal::jerk_limited : StopReversal::none;
    if (promise == StopPromise::path_keeping) {
        give_look_ahead(random, {.linear_mm = 0.005, .rotary_rad = 2e-5}, c.machine);
        c.machine.guard.promise = StopPromise::path_keeping;
    }
    for (std::size_t i = 0; i < c.machine.axes.size(); ++i) {
        const Axis& axis = c.machine.axes[i];
        const double low = axis.unlimited ? -20 : axis.min, high = axis.unlimited ? 20 : axis.max;
        c.start[i] = low + (high - low) * between(random, 0.1, 0.9);
    }
    c.motion_seed = random();
    c.board.seed = random();
    c.board.jerk_factor_max = random() % 2 == 0 ? 64 : 4;  // quick stops know no jerk
    c.board.deceleration_factor_max = 4;
    c.stop_at = c.machine.can.look_ahead_samples + 40 + random() % 300;
    return c;
}

/// Every axis makes for places that change on the way, each in its own time: a path that curves, as
/// hard as the limits let it. The lambda is copied with its state, and so begins anew.
CommandedMotion make_curve(const Machine& machine, std::uint64_t seed) {
    return [&machine, random = Random(seed), target = std::array<double, kAxesMax>{},
            share = std::array<double, kAxesMax>{},
            ticks = std::array<std::uint32_t, kAxesMax>{}](std::span<AxisMotion> axes) mutable {
        for (std::size_t i = 0; i < axes.size(); ++i) {
            const Axis& axis = machine.axes[i];
            if (ticks[i]-- == 0) {
                const double low = axis.unlimited ? -20 : axis.min;
                const double high = axis.unlimited ? 20 : axis.max;
                target[i] = low + (high - low) * between(random, 0.05, 0.95);
                share[i] = random() % 2 == 0 ? 1 : between(random, 0.05, 1);
                ticks[i] = static_cast<std::uint32_t>(random() % 150);
            }
            axes[i].jerk = approach_jerk(axis, axes[i], target[i], share[i], 1e-3);
        }
        return MotionTick{.is_over = false, .tool = machine.first_tool};
    };
}

struct Watched {
    LimitFact fact;
    std::uint64_t excused = 0;  // samples in a stop that was harder than free motion
};

/// One motion with its stop, as the guard sees it.
Watched watch(const StopCase& c, const LimitRules& rules) {
    const Machine& machine = c.machine;
    MotionBoard board(machine, {c.start.data(), machine.axes.size()},
                      make_curve(machine, c.motion_seed), c.board);
    LoopGuard guard = make_permit_guard(machine, 600);
    AxisReceiver receiver(machine);
    MotionHistory history;
    LimitWatch limits;
    Watched out;
    const auto on_frame = guard.on_frame;
    guard.on_frame = [&](const CanFrame& frame, std::vector<CanFrame>& sent) {
        on_frame(frame, sent);
        const ReceiverEvent event = receiver.on_frame(frame);
        if (event.kind != ReceiverEvent::Kind::snapshot || out.fact.kind != LimitKind::none) {
            return;
        }
        if (event.state != ReceiverState::valid) {
            history.count = 0;
            forget_limits(limits);
        }
        note_snapshot(history, event.snapshot, rules.stride);
        out.fact = note_limits(limits, rules, event.snapshot, history);
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            out.excused += limits.stops[i].is_on ? 1 : 0;
        }
    };
    ClosedLoop loop(board, {}, guard);
    std::uint64_t at_rest = 0;
    for (std::uint64_t k = 0; k < 4000 && at_rest < 40; ++k) {
        EXPECT_TRUE(loop.cycle());
        if (k == c.stop_at) {
            board.stop_by_person(board.next_latch_us());
        }
        at_rest += board.is_at_rest() ? 1 : 0;
    }
    EXPECT_TRUE(board.is_at_rest());
    return out;
}

class LegalStops : public testing::TestWithParam<StopPromise> {};

TEST_P(LegalStops, ShowNoBrokenLimit) {
    Random random(printed_seed(20261214));
    const std::uint64_t count = count_from_environment(400);
    std::uint64_t excused = 0;
    for (std::uint64_t n = 0; n < count; ++n) {
        const StopCase c = random_stop_case(random, GetParam());
        const Watched one = watch(c, limit_rules(c.machine, axis_units(c.machine)));
        excused += one.excused;
        ASSERT_EQ(one.fact.kind, LimitKind::none)
            << "case " << n << ": axis " << one.fact.axis << " " << to_text(one.fact.kind) << " "
            << one.fact.measured << ", declared " << one.fact.declared << ", sample "
            << one.fact.sample << " of " << c.stop_at << ", jerk limited "
            << c.machine.guard.free_jerk_limited;
    }
    std::printf("%s: %llu stops, %llu samples harder than free motion\n", to_text(GetParam()),
                static_cast<unsigned long long>(count), static_cast<unsigned long long>(excused));
    if (count >= 400) {
        EXPECT_GT(excused, count) << "too tame to tell anything";
    }
}

INSTANTIATE_TEST_SUITE_P(Each, LegalStops,
                         testing::Values(StopPromise::independent, StopPromise::path_keeping));

/// Of 200 stops, how many these rules call a broken limit.
template <class Change>
unsigned accused(StopPromise promise, Change change) {
    Random random(20261215);
    unsigned count = 0;
    for (int n = 0; n < 200; ++n) {
        const StopCase c = random_stop_case(random, promise);
        LimitRules rules = limit_rules(c.machine, axis_units(c.machine));
        change(rules);
        count += watch(c, rules).fact.kind != LimitKind::none ? 1 : 0;
    }
    return count;
}

TEST(LegalStopsAblations, EachPartIsNeeded) {
    const unsigned no_stop = accused(StopPromise::independent, [](LimitRules& rules) {
        for (AxisLimitRules& axis : rules.axes) {
            axis.stop_strides = 0;
        }
    });
    const unsigned no_path = accused(StopPromise::path_keeping,
                                     [](LimitRules& rules) { rules.stops_keep_path = false; });
    std::printf(
        "accused of 200: %u without stops of the board's own, %u with axes that may not "
        "speed up along a path\n",
        no_stop, no_path);
    EXPECT_GT(no_stop, 100U);
    EXPECT_GT(no_path, 0U);
}

}  // namespace
}  // namespace axg::test
