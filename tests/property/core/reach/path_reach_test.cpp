// SPDX-License-Identifier: Apache-2.0
// Stops of single axes from a look-ahead path: each axis follows its commands within the
// following error, swinging around them, and from some instant on brakes by itself, as late and as
// weakly as it may. Every position until rest has to lie in the pieces. The oracle moves by pieces
// of constant jerk of its own. AXG_COUNT: stops.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/reach/look_ahead_path.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

constexpr std::uint32_t kSingleAxes = 2;
constexpr std::uint64_t kUsualStops = 20'000, kDrivenTicks = 1000;
constexpr double kDrivenPeriodS = 1e-3;
constexpr double kOwnShare = 0.1;  // of acceleration and jerk, for swinging around the commands

Machine random_single_axes(Random& random) {
    Machine m;
    m.axes.resize(kSingleAxes);
    for (Axis& axis : m.axes) {
        axis.speed_max = between(random, 50, 1000);
        axis.acceleration_max = between(random, 1000, 10'000);
        axis.jerk_max = between(random, 20'000, 200'000);
        axis.stopping_min = axis.acceleration_max * between(random, 0.5, 1);
        axis.following_error = random() % 2 == 0 ? 0 : between(random, 0.0005, 0.05);
    }
    m.can.look_ahead_samples = kLookAheadSamplesMax;
    m.guard.free_jerk_limited = random() % 4 != 0;
    return m;
}

/// One axis: commands in pieces of one period, and a swing around them.
struct DrivenAlone {
    std::vector<AxisMotion> pieces;
    double stretch = 1;  // the board's period, of the nominal one
    double size = 0, rate = 0, phase = 0;

    DrivenAlone(Random& random, Axis axis, double period_share) : stretch(period_share) {
        const Axis whole = axis;
        if (axis.following_error > 0) {
            size = axis.following_error;
            rate = std::min(std::sqrt(kOwnShare * axis.acceleration_max / size),
                            std::cbrt(kOwnShare * axis.jerk_max / size));
            phase = between(random, 0, 2 * kPi);
            axis.acceleration_max *= 1 - kOwnShare;
            axis.jerk_max *= 1 - kOwnShare;
            axis.speed_max -= size * rate;
        }
        AxisMotion now;
        double target = 0, share = 1;
        for (std::uint64_t k = 0; k < kDrivenTicks; ++k) {
            if (k % 150 == 0 || random() % 200 == 0) {
                target = now.position + whole.speed_max * between(random, -1, 1);
                share = random() % 2 == 0 ? 1 : between(random, 0.05, 1);
            }
            now.jerk = approach_jerk(axis, now, target, share, kDrivenPeriodS * stretch);
            pieces.push_back(now);
            now = moved_on(now, kDrivenPeriodS * stretch);
        }
    }
    [[nodiscard]] AxisMotion commanded(double periods) const {
        const auto piece = static_cast<std::size_t>(periods);
        return moved_on(pieces[piece],
                        (periods - static_cast<double>(piece)) * kDrivenPeriodS * stretch);
    }
    [[nodiscard]] AxisMotion actual(double periods) const {
        AxisMotion at = commanded(periods);
        const double angle = phase + rate * periods * kDrivenPeriodS * stretch;
        at.position += size * std::sin(angle);
        at.speed += size * rate * std::cos(angle);
        at.acceleration -= size * rate * rate * std::sin(angle);
        return at;
    }
};

struct SingleStops {
    std::uint64_t stops = 0, outside = 0, not_known = 0;
    double most = 0;  // of the way that a box leaves to an axis when its stop begins
};

void note_driven_path(Random& random, const std::vector<DrivenAlone>& axes, double count,
                      LookAheadPath& path) {
    const double lost = random() % 2 == 0 ? 0 : between(random, 0, 0.1);
    for (std::uint64_t k = 1; k < kDrivenTicks; ++k) {
        PathPoints points;
        points.sample = k;
        for (std::uint32_t i = 0; i < kSingleAxes; ++i) {
            const auto counts = [&](std::uint64_t sample) {
                const double at = axes[i].commanded(static_cast<double>(sample)).position;
                return count * std::round(at / count);
            };
            points.position[i] = counts(k);
            points.before[i] = counts(k - 1);
        }
        if (between(random, 0, 1) >= lost) {
            ASSERT_TRUE(path.note_path(points));
        }
    }
}

void expect_inside(Random& random, const Machine& m, const std::vector<DrivenAlone>& axes,
                   std::uint64_t sample, double start, std::span<const JointBox> pieces,
                   const JointBox& leaf, SingleStops& seen) {
    bool is_inside = true;
    for (std::uint32_t i = 0; i < kSingleAxes; ++i) {
        const auto look = [&](double position, const JointBox& box) {
            const double away = std::abs(position - box.centre[i]);
            is_inside = is_inside && away <= box.half[i];
        };
        for (double at = static_cast<double>(sample); at < start; at += 0.1) {
            look(axes[i].actual(at).position, pieces[0]);
        }
        AxisMotion at = axes[i].actual(start);
        const bool is_soft = random() % 2 == 0;
        const Brake how{m.axes[i].stopping_min * (is_soft ? 1 : between(random, 1, 2)),
                        m.axes[i].jerk_max * (is_soft ? 1 : between(random, 1, 4))};
        const double begin = at.position;
        look(begin, leaf);
        while (!is_resting(at)) {
            brake(at, how, 0.5e-3);
            look(at.position, leaf);
        }
        const bool is_up = at.position > begin;
        const double edge = leaf.centre[i] + (is_up ? leaf.half[i] : -leaf.half[i]);
        if (std::abs(edge - begin) > 2) {
            seen.most = std::max(seen.most, (at.position - begin) / (edge - begin));
        }
    }
    ++seen.stops;
    seen.outside += is_inside ? 0 : 1;
}

SingleStops run_single_stops(Random& random, std::uint64_t count, bool forgets_jerk,
                             double early_s) {
    SingleStops seen;
    while (seen.stops < count) {
        const Machine m = random_single_axes(random);
        const double share = 1 + (random() % 2 == 0 ? 0 : between(random, -0.009, 0.009));
        std::vector<DrivenAlone> axes;
        for (const Axis& axis : m.axes) {
            axes.emplace_back(random, axis, share);
        }
        PathOptions options;
        options.count.fill(1e-4);
        Machine of_guard = m;
        if (forgets_jerk) {
            lab::forget_jerk_ramp(of_guard);
        }
        auto path = LookAheadPath::create(of_guard, options);
        EXPECT_TRUE(path);
        note_driven_path(random, axes, 1e-4, *path);
        const double free_s = between(random, 1e-3, 8e-3);
        for (std::uint64_t sample = 20; sample + 20 < kDrivenTicks; sample += 13) {
            std::array<JointBox, kReachPieces> pieces;
            if (!path->reach(sample, free_s - early_s, pieces)) {
                ++seen.not_known;
                continue;
            }
            const double late = random() % 2 == 0 ? 1 : between(random, 0, 1);
            const double start =
                static_cast<double>(sample) + late * free_s / (kDrivenPeriodS * share);
            const double periods = (free_s - early_s) / (kDrivenPeriodS * (1 - kPeriodShare));
            const double of_leaves = (start - static_cast<double>(sample)) / periods * kReachLeaves;
            const auto leaf =
                std::min<std::size_t>(static_cast<std::size_t>(of_leaves), kReachLeaves - 1);
            expect_inside(random, m, axes, sample, start, pieces, pieces[kReachLeaves - 1 + leaf],
                          seen);
        }
    }
    return seen;
}

TEST(PathReach, EveryStopStaysInThePieces) {
    Random random(printed_seed(20261125));
    const std::uint64_t count = count_from_environment(kUsualStops);
    const SingleStops seen = run_single_stops(random, count, false, 0);
    std::printf("%llu stops, worst %.4f of the way left, path not known %llu times\n",
                static_cast<unsigned long long>(seen.stops), seen.most,
                static_cast<unsigned long long>(seen.not_known));
    EXPECT_EQ(seen.outside, 0U);
    EXPECT_LT(20 * seen.not_known, seen.stops);
    const SingleStops no_jerk = run_single_stops(random, count / 4, true, 0);
    const SingleStops early = run_single_stops(random, count / 4, false, 1e-3);
    std::printf("outside: %llu without the jerk of braking, %llu a millisecond early\n",
                static_cast<unsigned long long>(no_jerk.outside),
                static_cast<unsigned long long>(early.outside));
    if (count >= kUsualStops) {
        constexpr const char* kWeak = "too weak to tell anything";
        EXPECT_GT(seen.most, 0.95) << kWeak;
        EXPECT_GT(no_jerk.outside, 0U) << kWeak;
        EXPECT_GT(early.outside, 0U) << kWeak;
    }
}

}  // namespace
}  // namespace axg::test
