// SPDX-License-Identifier: Apache-2.0
// Where an axis can go before it rests, against axes that are driven there: random legal motions,
// braked at a random instant, at the guaranteed deceleration or harder. AXG_COUNT: axes.
#include "core/reach/stop_reach.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/machine/machine.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

unsigned axis_count() {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? 20000U : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

AxisLimits random_limits(Random& random) {
    AxisLimits l;
    l.speed_max = std::exp2(between(random, 0, 10));
    l.acceleration_max = 1000 * std::exp2(between(random, -1, 4));
    l.jerk_max = 20000 * std::exp2(between(random, 0, 4));
    l.stopping_min = l.acceleration_max * between(random, 0.5, 1.5);
    return l;
}

/// One axis moved by small steps of constant jerk, exactly; keeps how far it got either way.
struct Driven {
    const AxisLimits& limits;
    double position = 0, speed = 0, low = 0, high = 0;

    /// Acceleration a, changing by jerk, for a time; the speed stays within its limits.
    void go(double a, double jerk, double time) {
        const double end = std::clamp(speed + a * time + 0.5 * jerk * time * time,
                                      -limits.speed_max, limits.speed_max);
        position += time * (speed + time * (0.5 * a + time * jerk / 6));
        speed = end;
        low = std::min(low, position), high = std::max(high, position);
    }
    void drive_freely(Random& random, double time) {
        while (time > 0) {
            const double step = std::min(time, between(random, 1e-5, 1e-3));
            const double choice = between(random, -1.5, 1.5);
            double a = std::clamp(choice, -1.0, 1.0) * limits.acceleration_max;
            // Not beyond the largest speed: less acceleration, in time.
            a = std::clamp(a, (-limits.speed_max - speed) / step,
                           (limits.speed_max - speed) / step);
            go(a, 0, step);
            time -= step;
        }
    }
    /// Brakes to standstill from an acceleration of `start` (positive: still speeding up).
    void brake(double start, double deceleration, double jerk) {
        const double sign = speed >= 0 ? 1 : -1;
        double a = jerk < kNoJerkLimit ? start : -deceleration;  // along the motion
        while (sign * speed > 0) {
            // Jerk while the braking builds up, then none; short enough to see the standstill.
            const double ramp = (a + deceleration) / jerk;
            const bool is_building = ramp > 1e-9;
            const double step = is_building ? std::min(ramp, 1e-5) : 1e-5;
            const double stop = is_building ? HUGE_VAL : sign * speed / deceleration;
            const double time = std::min(step, stop);
            go(sign * a, is_building ? -sign * jerk : 0, time);
            a = is_building ? a - jerk * time : -deceleration;
            if (time == stop) {
                speed = 0;
            }
        }
    }
};

/// How much of its reach the worst of so many axes used, each driven freely and then braked.
double widest_share_used(Random& random, bool has_jerk_limit) {
    double widest = 0;
    for (unsigned i = 0; i < axis_count() && !testing::Test::HasFailure(); ++i) {
        AxisLimits limits = random_limits(random);
        limits.jerk_max = has_jerk_limit ? limits.jerk_max : kNoJerkLimit;
        const double speed = between(random, -1, 1) * limits.speed_max;
        const double free_s = between(random, 0, 0.01);
        const ReachRange reach = stop_reach(limits, {0, 0, speed, speed}, free_s);
        Driven axis{limits};
        axis.speed = speed;
        axis.drive_freely(random, free_s * ((random() & 1U) != 0 ? 1 : between(random, 0, 1)));
        const double harder = (random() & 1U) != 0 ? 1 : between(random, 1, 4);
        const double jerk = limits.jerk_max * between(random, 1, 4);
        // No more acceleration than the jerk can take away before the largest speed.
        const double room = limits.speed_max - std::fabs(axis.speed);
        const double most = std::min(limits.acceleration_max, std::sqrt(2 * jerk * room));
        const double start = (random() & 1U) != 0 ? 1 : between(random, -1, 1);
        axis.brake(start * most, harder * limits.stopping_min, jerk);
        const double size = 1e-9 + 1e-7 * (reach.high - reach.low);  // the steps' own errors
        EXPECT_LE(axis.high, reach.high + size) << "axis " << i;
        EXPECT_GE(axis.low, reach.low - size) << "axis " << i;
        if (reach.high > 0.01) {
            widest = std::max(widest, axis.high / reach.high);
        }
    }
    return widest;
}

TEST(StopReach, NoLegalMotionLeavesIt) {
    Random random(printed_seed(20261150));
    for (const bool has_jerk_limit : {true, false}) {
        const double widest = widest_share_used(random, has_jerk_limit);
        std::printf("at most %.3f of the reach was used\n", widest);
        EXPECT_GT(widest, 0.9) << (has_jerk_limit ? "jerk limited" : "no limit of jerk");
    }
}

// Full acceleration to the last instant, then the guaranteed braking: that is the reach, so a
// formula that forgets the free motion, the ramp or the braking is exceeded.
TEST(StopReach, IsReachedByTheWorstMotion) {
    Random random(printed_seed(20261151));
    for (unsigned i = 0; i < axis_count() / 20 && !HasFailure(); ++i) {
        AxisLimits limits = random_limits(random);
        const double speed = between(random, -0.2, 1) * limits.speed_max;
        const double free_s = between(random, 0.001, 0.01);
        limits.speed_max = 1e9;  // no cap: the ramp's last rise is then real
        const double reach = forward_reach(limits, speed, speed, free_s);
        Driven axis{limits};
        axis.speed = speed;
        const double turning = std::max(0.0, -speed / limits.acceleration_max);
        if (turning >= free_s) {
            EXPECT_EQ(reach, 0) << "going back the whole time";
            continue;
        }
        axis.go(limits.acceleration_max, 0, turning);
        const double from = axis.position;  // the way back does not count as a gain
        axis.go(limits.acceleration_max, 0, free_s - turning);
        axis.brake(limits.acceleration_max, limits.stopping_min, limits.jerk_max);
        EXPECT_NEAR((axis.position - from) / reach, 1, 1e-5)
            << "axis " << i << " speed " << speed << " a " << limits.acceleration_max << " d "
            << limits.stopping_min << " j " << limits.jerk_max << " t " << free_s << " reach "
            << reach;
    }
}

/// Jerk up to the limit at random, acceleration and speed within theirs. False: no legal way was
/// found to stay below the largest speed.
bool drive_with_jerk(Driven& axis, double& a, Random& random, double time) {
    const AxisLimits& l = axis.limits;
    const double favourite = between(random, -1.5, 1.5);
    while (time > 0) {
        const double step = std::min(time, between(random, 1e-5, 1e-3));
        const double choice = std::clamp(favourite + between(random, -0.5, 0.5), -1.0, 1.0);
        const double end =
            std::clamp(a + choice * l.jerk_max * step, -l.acceleration_max, l.acceleration_max);
        const double jerk = (end - a) / step;
        // The speed that the acceleration still adds while the jerk takes it away.
        const double later = axis.speed + 0.5 * (a + end) * step;
        const double settled = later + end * std::fabs(end) / (2 * l.jerk_max);
        if (std::fabs(later) > l.speed_max || std::fabs(settled) > l.speed_max) {
            return false;
        }
        axis.go(a, jerk, step);
        a = end;
        time -= step;
    }
    return true;
}

/// A stop that keeps its jerk: an acceleration against the motion turns the axis round where the
/// jerk is too small to take it away before. False: it does not turn round.
bool turn_round(Driven& axis, double& a, double jerk) {
    const double way = a > 0 ? 1 : -1;
    const double square = a * a - 2 * jerk * std::fabs(axis.speed);
    if (axis.speed * a >= 0 || square <= 0) {
        return false;
    }
    const double time = (std::fabs(a) - std::sqrt(square)) / jerk;
    axis.go(a, -way * jerk, time);
    axis.speed = 0;
    a = way * std::sqrt(square);
    constexpr double kStepS = 1e-7;  // so that it has a direction
    const double step = std::min(kStepS, std::fabs(a) / jerk);
    axis.go(a, -way * jerk, step);
    a -= way * jerk * step;
    return true;
}

/// Of axes whose stops turn them round, how far one got beyond its reach at most, and the largest
/// share of a reach that one used.
struct Turned {
    unsigned count = 0;
    double beyond = 0, share = 0;
};
Turned drive_turning(bool is_believed, bool keeps_jerk) {
    Random random(keeps_jerk ? 20261155 : 20261156);
    Turned out;
    for (unsigned i = 0; i < axis_count(); ++i) {
        AxisLimits limits = random_limits(random);
        limits.stop_turns_round = is_believed;
        const double speed = between(random, -1, 1) * limits.speed_max;
        const double free_s = between(random, 0, 0.01);
        double a = between(random, -1, 1) * limits.acceleration_max;
        const AxisRange now =
            keeps_jerk ? AxisRange{0, 0, speed, speed, a, a} : AxisRange{0, 0, speed, speed};
        const ReachRange reach = stop_reach(limits, now, free_s);
        Driven axis{limits};
        axis.speed = speed;
        const double until = free_s * ((random() & 1U) != 0 ? 1 : between(random, 0, 1));
        if (keeps_jerk) {
            if (!drive_with_jerk(axis, a, random, until)) {
                continue;
            }
        } else {
            axis.drive_freely(random, until);
            a = ((random() & 1U) != 0 ? 1 : between(random, 0, 1)) *
                (axis.speed < 0 ? limits.acceleration_max : -limits.acceleration_max);
        }
        const double jerk = limits.jerk_max * ((random() & 1U) != 0 ? 1 : between(random, 1, 4));
        const double swing = std::fabs(axis.speed + 0.5 * a * std::fabs(a) / jerk);
        if (swing > limits.speed_max || !turn_round(axis, a, jerk)) {
            continue;
        }
        ++out.count;
        const double harder = (random() & 1U) != 0 ? 1 : between(random, 1, 4);
        axis.brake(std::fabs(a), harder * limits.stopping_min, jerk);
        const double size = 1e-9 + 1e-6 * (reach.high - reach.low);
        out.beyond =
            std::max({out.beyond, axis.high - reach.high - size, reach.low - axis.low - size});
        if (reach.high > 0.01) {
            out.share = std::max(out.share, axis.high / reach.high);
        }
    }
    return out;
}

// stop_reversal: jerk_limited. Believed to brake without turning round, the same axes get farther.
TEST(StopReach, NoStopThatTurnsRoundLeavesIt) {
    for (const bool keeps_jerk : {false, true}) {
        const Turned turned = drive_turning(true, keeps_jerk);
        const Turned not_believed = drive_turning(false, keeps_jerk);
        std::printf(
            "%u turned round, at most %.3f of the reach was used; %.2f mm beyond it where "
            "no stop is believed to do so\n",
            turned.count, turned.share, not_believed.beyond);
        EXPECT_LE(turned.beyond, 0);
        if (axis_count() >= 20000) {
            EXPECT_GT(turned.count, axis_count() / 50);
            EXPECT_GT(turned.share, 0.9);
            EXPECT_GT(not_believed.beyond, 1);
        }
    }
}

// jerk_...: none. Braking alone from the speed at the end of free motion, at most the largest.
TEST(StopReach, WithoutALimitOfJerkThereIsNoRamp) {
    const AxisLimits limits{
        .speed_max = 500, .acceleration_max = 4000, .jerk_max = kNoJerkLimit, .stopping_min = 3500};
    const auto braking = [](double speed) { return speed * speed / 7000; };
    EXPECT_NEAR(forward_reach(limits, 100, 100, 0), braking(100), 1e-6);
    EXPECT_NEAR(forward_reach(limits, 100, 100, 0.01), 1.2 + braking(140), 1e-6);
    EXPECT_NEAR(forward_reach(limits, 500, 500, 0), braking(500), 1e-6);
    EXPECT_NEAR(forward_reach(limits, 0, 0, 0), 0, 1e-6);
    AxisLimits turning = limits;
    turning.stop_turns_round = true;
    EXPECT_NEAR(forward_reach(turning, -1, -1, 0), 0, 1e-6) << "no jerk turns it round";
}

// The paper's machine, as docs/theory/certificate.md has it: 17 mm from the point where it turns
// round.
TEST(StopReach, AStopThatTurnsRoundByHand) {
    AxisLimits limits{
        .speed_max = 500, .acceleration_max = 4000, .jerk_max = 50'000, .stopping_min = 3500};
    const auto reach = [&limits](double speed) { return forward_reach(limits, speed, speed, 0); };
    EXPECT_EQ(reach(-0.001), 0);
    limits.stop_turns_round = true;
    EXPECT_NEAR(reach(0), 17.08, 0.01);
    EXPECT_NEAR(reach(-0.001), 17.08, 0.01);
    EXPECT_GT(reach(-159), 0);
    EXPECT_EQ(reach(-160.1), 0) << "b^2 / 2j";
}

// The acceleration at the start is known, and free motion keeps the jerk as well.
TEST(StopReach, NoMotionOfLimitedJerkLeavesTheSmallerReach) {
    Random random(printed_seed(20261153));
    double widest = 0;
    unsigned legal = 0;
    for (unsigned i = 0; i < axis_count() && !HasFailure(); ++i) {
        AxisLimits limits = random_limits(random);
        limits.jerk_max *= between(random, 1, 8);
        const double speed = between(random, -1, 1) * limits.speed_max;
        const double free_s = between(random, 0, 0.02);
        double a = between(random, -1, 1) * limits.acceleration_max;
        const AxisRange now{0, 0, speed, speed, a, a};
        const ReachRange reach = stop_reach(limits, now, free_s);
        Driven axis{limits};
        axis.speed = speed;
        const double until = free_s * ((random() & 1U) != 0 ? 1 : between(random, 0, 1));
        if (!drive_with_jerk(axis, a, random, until)) {
            continue;
        }
        ++legal;
        const double harder = (random() & 1U) != 0 ? 1 : between(random, 1, 4);
        const double along = axis.speed >= 0 ? a : -a;
        axis.brake(std::max(along, -harder * limits.stopping_min), harder * limits.stopping_min,
                   limits.jerk_max * between(random, 1, 4));
        const double size = 1e-9 + 1e-7 * (reach.high - reach.low);
        EXPECT_LE(axis.high, reach.high + size) << "axis " << i;
        EXPECT_GE(axis.low, reach.low - size) << "axis " << i;
        const ReachRange unknown = stop_reach(limits, {0, 0, speed, speed}, free_s);
        EXPECT_LE(reach.high, unknown.high * (1 + 1e-9)) << "axis " << i;
        EXPECT_GE(reach.low, unknown.low * (1 + 1e-9)) << "axis " << i;
        if (reach.high > 0.01) {
            widest = std::max(widest, axis.high / reach.high);
        }
    }
    std::printf("%u of %u motions legal, at most %.3f of the reach was used\n", legal, axis_count(),
                widest);
    if (axis_count() >= 20000) {
        EXPECT_GT(legal, axis_count() / 4);
        EXPECT_GT(widest, 0.9);
    }
}

// Full jerk to the last instant, then the guaranteed braking.
TEST(StopReach, IsReachedByTheWorstMotionOfLimitedJerk) {
    Random random(printed_seed(20261154));
    for (unsigned i = 0; i < axis_count() / 20 && !HasFailure(); ++i) {
        AxisLimits limits = random_limits(random);
        const double speed = between(random, 0, 1) * limits.speed_max;
        const double free_s = between(random, 0.001, 0.01);
        const double a = between(random, 0, 1) * limits.acceleration_max;
        limits.speed_max = 1e9;
        const double reach = forward_reach(limits, speed, speed, free_s, a);
        Driven axis{limits};
        axis.speed = speed;
        const double rise = std::min(free_s, (limits.acceleration_max - a) / limits.jerk_max);
        axis.go(a, limits.jerk_max, rise);
        axis.go(limits.acceleration_max, 0, free_s - rise);
        axis.brake(a + limits.jerk_max * rise, limits.stopping_min, limits.jerk_max);
        EXPECT_NEAR(axis.position / reach, 1, 5e-5) << "axis " << i;  // braked in small steps
        EXPECT_LE(axis.position, reach * (1 + 1e-9)) << "axis " << i;
    }
}

TEST(StopReach, GrowsWithTheRangeOfSpeedsAndWithTime) {
    Random random(printed_seed(20261152));
    for (unsigned i = 0; i < 2000 && !HasFailure(); ++i) {
        const AxisLimits limits = random_limits(random);
        const double low = between(random, -1, 1) * limits.speed_max, free_s = 0.004;
        const double high = low + between(random, 0, 0.1) * limits.speed_max;
        const double reach = forward_reach(limits, low, high, free_s);
        const double more = between(random, 0, 0.1);
        const auto at_least = [reach](double wider) { EXPECT_GE(wider * (1 + 1e-12), reach); };
        at_least(forward_reach(limits, low, high + more * limits.speed_max, free_s));
        at_least(forward_reach(limits, low - more * limits.speed_max, high, free_s));
        at_least(forward_reach(limits, low, high, free_s * (1 + more)));
        AxisLimits weaker = limits;
        weaker.stopping_min *= 1 - more;
        at_least(forward_reach(weaker, low, high, free_s));
        weaker = limits;
        weaker.jerk_max *= 1 - more;
        at_least(forward_reach(weaker, low, high, free_s));
        const ReachRange range = stop_reach(limits, {-1, 2, low, high}, free_s);
        EXPECT_LE(range.low, -1);
        EXPECT_GE(range.high, 2);
    }
}

// 10 m/min, 5 m/s2 both ways, 200 m/s3, 4 ms. Free: 166.667 * 0.004 + 2500 * 0.004^2 = 0.70667,
// then u = 186.667. Ramp of 0.05 s: 0.05 u + 2500 * 0.05^2 - 200000 * 0.05^3 / 6 = 11.41667, at u
// again. Then u^2 / 10000 = 3.48444.
TEST(StopReach, IsWhatAHandCalculationGives) {
    const AxisLimits limits{
        .speed_max = 1000, .acceleration_max = 5000, .jerk_max = 200000, .stopping_min = 5000};
    EXPECT_NEAR(forward_reach(limits, 10000.0 / 60, 10000.0 / 60, 0.004), 15.60778, 1e-5);
}

}  // namespace
}  // namespace axg::test
