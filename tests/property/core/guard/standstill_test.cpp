// SPDX-License-Identifier: Apache-2.0
// Axes that move by 0.1 mm/s or more, seen as badly as the machine file allows, are never taken for
// standing; axes at rest are. Wrong rules, made here, fail. AXG_COUNT: axes.
#include "core/guard/standstill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/sincos.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

/// A machine whose axis `moving` is seen with errors of its own.
struct Case {
    Machine machine;
    std::array<double, kAxesMax> count{};
    std::uint32_t moving = 0;
    double unit = 1;      // mm, or the rad of a degree
    double period_s = 0;  // true one
};

Case random_case(Random& random) {
    constexpr std::uint32_t kPeriodsUs[] = {250, 1000, 1000, 2000, 5000, 10'000};
    Case c;
    c.machine = five_axis_machine(CanFormat::classical);
    c.machine.can.sample_us = kPeriodsUs[random() % 6];
    c.moving = static_cast<std::uint32_t>(random() % 5);
    for (std::uint32_t i = 0; i < 5; ++i) {
        Axis& axis = c.machine.axes[i];
        const double unit = axis.kind == AxisKind::rotary ? kPi / 180 : 1.0;
        c.count[i] = unit * 1e-4 * std::exp2(between(random, 0, 4));
        axis.position_error = unit * between(random, 0, 8e-3);
    }
    c.unit = c.machine.axes[c.moving].kind == AxisKind::rotary ? kPi / 180 : 1.0;
    c.period_s = 1e-6 * c.machine.can.sample_us * (1 + between(random, -0.01, 0.01));
    return c;
}

/// What the board reports of a true position: off by the error, rounded to a count.
/// @param off  share of the error, -1 to 1
double reported(const Case& c, std::uint32_t axis, double position, double off) {
    const double with_error = position + off * c.machine.axes[axis].position_error;
    return std::round(with_error / c.count[axis]) * c.count[axis];
}

/// An error at random; or the one that hides a motion as long as it can.
double share_of_error(Random& random, const Case& c, bool hides, double way) {
    const double error = c.machine.axes[c.moving].position_error;
    if (hides && error > 0) {
        const double left = 1 - std::min(2.0, std::fabs(way) / error);
        return way < 0 ? -left : left;
    }
    return std::clamp(between(random, -3, 3), -1.0, 1.0);
}

/// Samples at which it stood, over three windows.
/// @param speed  mm/s or degrees/s
std::uint64_t samples_stood(Random& random, const Case& c, const StandstillRules& rules,
                            double speed) {
    Standstill state;
    std::uint64_t stood = 0;
    const std::uint64_t samples =
        3 * standstill_rules(c.machine, c.count).window_samples + 2 * kStandstillParts;
    const double start = between(random, -0.1, 0.1);
    const bool hides = (random() & 1U) != 0;
    for (std::uint64_t k = 0; k < samples; ++k) {
        const bool may_lose = c.machine.can.sample_us <= 2000;
        if (may_lose && random() % 100 == 0) {
            continue;
        }
        AxisSnapshot snapshot;
        snapshot.sample = k;
        snapshot.latched_us = static_cast<std::int64_t>(k) * c.machine.can.sample_us;
        const double late_s = between(random, 0, 20e-6);
        const double way = speed * c.unit * (static_cast<double>(k) * c.period_s + late_s);
        for (std::uint32_t i = 0; i < 5; ++i) {
            const bool is_moving = i == c.moving;
            const double off = share_of_error(random, c, hides && is_moving, way);
            snapshot.position[i] = reported(c, i, start + (is_moving ? way : 0), off);
        }
        if (c.machine.axes[4].unlimited) {
            snapshot.position[4] -= 2 * kPi * std::floor(snapshot.position[4] / (2 * kPi));
        }
        note_standstill(state, rules, snapshot, true);
        stood += stands(state, rules, snapshot.latched_us) ? 1 : 0;
    }
    return stood;
}

TEST(Standstill, AMovingAxisNeverStands) {
    Random random(printed_seed(20261200));
    const auto axes = count_from_environment(10'000);
    for (std::uint64_t n = 0; n < axes && !testing::Test::HasFailure(); ++n) {
        const Case c = random_case(random);
        const double speed = 0.1 * std::exp2(std::max(0.0, between(random, -8, 8)));
        const double sign = (random() & 1U) != 0 ? 1 : -1;
        EXPECT_EQ(samples_stood(random, c, standstill_rules(c.machine, c.count), sign * speed), 0U)
            << n << ": " << speed << " a second";
    }
}

TEST(Standstill, AnAxisAtRestAlwaysStandsInTheEnd) {
    Random random(printed_seed(20261201));
    for (std::uint64_t n = 0; n < 300 && !testing::Test::HasFailure(); ++n) {
        const Case c = random_case(random);
        const StandstillRules rules = standstill_rules(c.machine, c.count);
        EXPECT_GT(samples_stood(random, c, rules, 0), rules.window_samples / 2) << n;
    }
}

/// Of 1,000 axes that move slowly, how many stand by these rules.
template <class Change>
unsigned deceived(Change change) {
    Random random(20261202);
    unsigned count = 0;
    for (unsigned n = 0; n < 1000; ++n) {
        const Case c = random_case(random);
        StandstillRules rules = standstill_rules(c.machine, c.count);
        change(rules, c);
        const double speed = 0.1 * std::exp2(between(random, 0, 1));
        count += samples_stood(random, c, rules, speed) > 0 ? 1 : 0;
    }
    return count;
}

TEST(StandstillAblations, EachPartIsNeeded) {
    EXPECT_EQ(deceived([](StandstillRules&, const Case&) {}), 0U);
    const unsigned two_samples =
        deceived([](StandstillRules& rules, const Case&) { rules.window_samples = 1; });
    // Without the part of the window that grows with the width.
    const unsigned fixed_window = deceived([](StandstillRules& rules, const Case& c) {
        const double s = std::max(0.1, 16e-6 * c.machine.can.sample_us);
        rules.window_samples = static_cast<std::uint64_t>(s / (1e-6 * c.machine.can.sample_us));
    });
    const unsigned one_axis =
        deceived([](StandstillRules& rules, const Case&) { rules.axis_count = 1; });
    std::printf("deceived: %u by two samples, %u by 100 ms alone, %u by one axis alone\n",
                two_samples, fixed_window, one_axis);
    EXPECT_GT(two_samples, 900U);
    EXPECT_GT(fixed_window, 100U);
    EXPECT_GT(one_axis, 700U);
}

}  // namespace
}  // namespace axg::test
