// SPDX-License-Identifier: Apache-2.0
// Stops along random curved paths against what was proven of them from its points alone:
// three axes race for random targets at the limits of speed, acceleration and jerk, frames are
// lost, and the stop begins as late and is as weak as it may be. Every position until rest has to
// lie in the pieces. The oracle moves by pieces of constant jerk of its own. AXG_COUNT: stops.
#include "core/reach/look_ahead_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "core/base/sincos.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

constexpr std::uint32_t kRacingAxes = 3, kTurningAxis = 2;
constexpr std::uint64_t kUsual = 10'000;
constexpr double kPeriodS = 1e-3;
constexpr std::uint64_t kTicks = 1400;

Machine random_racing_machine(Random& random) {
    Machine m;
    m.axes.resize(kRacingAxes);
    for (std::uint32_t i = 0; i < kRacingAxes; ++i) {
        Axis& axis = m.axes[i];
        const bool is_linear = i != kTurningAxis;
        axis.kind = is_linear ? AxisKind::linear : AxisKind::rotary;
        axis.unlimited = !is_linear;
        const double size = is_linear ? 1 : 0.01;
        axis.speed_max = size * between(random, 50, 1000);
        axis.acceleration_max = size * between(random, 1000, 10'000);
        axis.jerk_max = size * between(random, 20'000, 200'000);
        axis.stopping_min = axis.acceleration_max * between(random, 0.5, 1);
        axis.following_error = random() % 2 == 0 ? 0 : size * between(random, 0.001, 0.05);
    }
    m.can.look_ahead_samples = kLookAheadSamplesMax;
    m.guard.free_jerk_limited = random() % 2 == 0;
    return m;
}

/// What the commands do, piece by piece of one period.
struct Commanded {
    std::vector<std::array<AxisMotion, kRacingAxes>> pieces;

    Commanded(Random& random, const Machine& m) {
        std::array<AxisMotion, kRacingAxes> now{};
        std::array<double, kRacingAxes> target{}, share{};
        for (std::uint64_t k = 0; k < kTicks; ++k) {
            for (std::uint32_t i = 0; i < kRacingAxes; ++i) {
                if (k % 200 == 0 || random() % 300 == 0) {
                    target[i] = now[i].position + m.axes[i].speed_max * between(random, -1, 1);
                    share[i] = random() % 2 == 0 ? 1 : between(random, 0.05, 1);
                }
                now[i].jerk = approach_jerk(m.axes[i], now[i], target[i], share[i], kPeriodS);
            }
            pieces.push_back(now);
            for (AxisMotion& axis : now) {
                axis = moved_on(axis, kPeriodS);
            }
        }
    }
    [[nodiscard]] AxisMotion at(std::uint32_t axis, double periods) const {
        const auto piece = std::min<std::size_t>(static_cast<std::size_t>(periods), kTicks - 1);
        const double since = (periods - static_cast<double>(piece)) * kPeriodS;
        return moved_on(pieces[piece][axis], since);
    }
    /// Largest speed between two instants: at an end of a piece, or where the acceleration is zero.
    [[nodiscard]] double fastest(std::uint32_t axis, double from, double to) const {
        double most = std::abs(at(axis, from).speed);
        while (from < to) {
            const double end = std::min(to, std::floor(from) + 1);
            const AxisMotion begin = at(axis, from);
            most = std::max(most, std::abs(moved_on(begin, (end - from) * kPeriodS).speed));
            const double level = begin.jerk == 0 ? -1 : -begin.acceleration / begin.jerk;
            if (level > 0 && level < (end - from) * kPeriodS) {
                most = std::max(most, std::abs(moved_on(begin, level).speed));
            }
            from = end;
        }
        return most;
    }
};

/// Counts as a frame carries them: what the guard hears of a position.
double heard(double position, std::uint32_t axis, double count) {
    double p = count * std::round(position / count);
    return axis == kTurningAxis ? p - 2 * kPi * std::floor(p / (2 * kPi)) : p;
}

/// @param pace  periods of the commands that one of the board's lasts
/// @return frames that were refused
std::uint64_t note_path_all(Random& random, const Commanded& commanded, const PathOptions& options,
                            double lost, std::uint64_t until, LookAheadPath& path,
                            double pace = 1) {
    std::uint64_t refused = 0;
    for (std::uint64_t k = 1; k <= until; ++k) {
        if (between(random, 0, 1) < lost) {
            continue;
        }
        PathPoints points;
        points.sample = k;
        for (std::uint32_t i = 0; i < kRacingAxes; ++i) {
            const auto said = [&](std::uint64_t sample) {
                const AxisMotion at = commanded.at(i, pace * static_cast<double>(sample));
                return heard(at.position, i, options.count[i]);
            };
            points.position[i] = said(k);
            points.before[i] = said(k - 1);
        }
        refused += path.note_path(points) ? 0 : 1;
    }
    return refused;
}

/// How a board stops that keeps the promise and no more: at the slowest rates of the shortest
/// stretch that a stop at its slowest rates ends in. In periods and s.
struct Stop {
    double begin, deceleration, jerk;
};

Stop weakest_stop(const Machine& m, const Commanded& commanded, double begin) {
    double end = begin;
    while (true) {  // from below: the stretch grows until the stop ends in it
        double p = 1e-12, z = 1e-12;
        for (std::uint32_t i = 0; i < kRacingAxes; ++i) {
            const double speed = commanded.fastest(i, begin, end);
            p = std::max(p, speed / m.axes[i].stopping_min);
            z = std::max(z, speed / m.axes[i].jerk_max);
        }
        AxisMotion rate{.position = 0, .speed = 1};
        brake(rate, {.deceleration = 1 / p, .jerk = 1 / z}, 1e9);
        const double rest = begin + rate.position / kPeriodS;
        if (rest <= end + 1e-6) {
            return {begin, 1 / p, 1 / z};
        }
        end = rest;
    }
}

struct Seen {
    std::uint64_t stops = 0, outside = 0;
    double most_of_end = 0;
};

void expect_in_pieces(Random& random, const Machine& m, const Commanded& commanded,
                      std::uint64_t sample, const PathStretch& stretch,
                      std::span<const JointBox> pieces, const Stop& stop, Seen& seen) {
    std::array<double, kRacingAxes> off{};
    for (std::uint32_t i = 0; i < kRacingAxes; ++i) {
        const double error = m.axes[i].following_error;
        off[i] = random() % 2 == 0 ? (random() % 2 == 0 ? error : -error)
                                   : between(random, -error, error);
    }
    const auto is_inside = [&](const JointBox& box, double at) {
        bool inside = true;
        for (std::uint32_t i = 0; i < kRacingAxes; ++i) {
            double away = commanded.at(i, at).position + off[i] - box.centre[i];
            if (i == kTurningAxis) {
                away -= 2 * kPi * std::round(away / (2 * kPi));
            }
            inside = inside && std::abs(away) <= box.half[i];
        }
        return inside;
    };
    const auto first = static_cast<double>(sample);
    AxisMotion rate{.position = 0, .speed = 1};
    double at = first;
    const auto look = [&](double periods) {
        const double share = (periods - first) / stretch.end;
        seen.most_of_end = std::max(seen.most_of_end, share);
        bool is_covered = share <= 1 && is_inside(pieces[0], periods);
        const auto leaf = static_cast<std::int64_t>(share * kPathLeaves);
        bool in_leaf = false;
        for (std::int64_t i = std::max<std::int64_t>(0, leaf - 1);
             i <= std::min<std::int64_t>(kPathLeaves - 1, leaf + 1); ++i) {
            in_leaf = in_leaf ||
                      is_inside(pieces[kPathLeaves - 1 + static_cast<std::size_t>(i)], periods);
        }
        is_covered = is_covered && in_leaf;
        seen.outside += is_covered ? 0 : 1;
    };
    for (; at < stop.begin; at += 0.1) {
        look(at);
    }
    while (!is_resting(rate)) {
        look(stop.begin + rate.position / kPeriodS);
        brake(rate, {.deceleration = stop.deceleration, .jerk = stop.jerk}, 0.2e-3);
    }
    look(stop.begin + rate.position / kPeriodS);
    ++seen.stops;
}

Seen run(Random& random, std::uint64_t count, bool forgets_jerk, bool forgets_late_start) {
    Seen seen;
    while (seen.stops < count) {
        const Machine m = random_racing_machine(random);
        const Commanded commanded(random, m);
        PathOptions options;
        options.count = {1e-4, 1e-4, 1e-4 * kPi / 180};
        Machine of_guard = m;
        if (forgets_jerk) {
            lab::forget_jerk_ramp(of_guard);
        }
        auto path = LookAheadPath::create(of_guard, options);
        EXPECT_TRUE(path);
        const double lost = random() % 2 == 0 ? 0 : between(random, 0, 0.1);
        EXPECT_EQ(note_path_all(random, commanded, options, lost, kTicks - 300, *path), 0U);
        const double free_s = between(random, 1e-3, 8e-3);
        for (std::uint64_t sample = kTicks - 300 - 1000; sample < kTicks - 300; sample += 37) {
            const PathStretch stretch =
                path->stretch(sample, forgets_late_start ? free_s - 1e-3 : free_s);
            if (!stretch.is_known) {
                continue;
            }
            std::array<JointBox, kPathPieces> pieces;
            path->cut(sample, stretch.end, pieces);
            const double late = random() % 2 == 0 ? free_s : between(random, 0, free_s);
            Stop stop = weakest_stop(m, commanded, static_cast<double>(sample) + late / kPeriodS);
            if (random() % 2 == 0) {
                stop.deceleration *= between(random, 1, 2);
                stop.jerk *= between(random, 1, 4);
            }
            expect_in_pieces(random, m, commanded, sample, stretch, pieces, stop, seen);
        }
    }
    return seen;
}

TEST(LookAheadPathProperty, EveryStopStaysInThePieces) {
    Random random(printed_seed(20261123));
    const std::uint64_t count = count_from_environment(kUsual);
    const Seen seen = run(random, count, false, false);
    std::printf("%llu stops, worst %.4f of the stretch\n",
                static_cast<unsigned long long>(seen.stops), seen.most_of_end);
    EXPECT_EQ(seen.outside, 0U);
    const Seen no_jerk = run(random, count / 4, true, false);
    const Seen early = run(random, count / 4, false, true);
    std::printf("outside: %llu without the jerk of braking, %llu a millisecond early\n",
                static_cast<unsigned long long>(no_jerk.outside),
                static_cast<unsigned long long>(early.outside));
    if (count >= kUsual) {
        constexpr const char* kWeak = "too weak to tell anything";
        EXPECT_GT(seen.most_of_end, 0.95) << kWeak;
        EXPECT_GT(no_jerk.outside, 0U) << kWeak;
        EXPECT_GT(early.outside, 0U) << kWeak;
    }
}

// The board's period is off by up to a hundredth, frames are lost: what keeps the limits is
// believed, to the last point. The same paths 5 % faster are not, where they use a limit at all.
TEST(LookAheadPathProperty, NoPathWithinTheLimitsIsRefused) {
    Random random(printed_seed(20261125));
    const std::uint64_t count = count_from_environment(kUsual);
    std::uint64_t paths = 0, points = 0, refused = 0, faster_refused = 0;
    for (; points < 20 * count; ++paths) {
        const Machine m = random_racing_machine(random);
        const Commanded commanded(random, m);
        PathOptions options;
        options.count = {1e-4, 1e-4, 1e-4 * kPi / 180};
        const double lost = random() % 2 == 0 ? 0 : between(random, 0, 0.3);
        const double pace = random() % 2 == 0 ? 1 + kPeriodShare : between(random, 0.99, 1.01);
        auto path = LookAheadPath::create(m, options), faster = LookAheadPath::create(m, options);
        ASSERT_TRUE(path && faster);
        const std::uint64_t until = kTicks - 100;
        refused += note_path_all(random, commanded, options, lost, until, *path, pace);
        faster_refused +=
            note_path_all(random, commanded, options, lost, until, *faster, 1.05) != 0 ? 1U : 0U;
        points += until;
    }
    std::printf("%llu paths of %llu points: %llu refused; 5 %% faster %llu paths\n",
                static_cast<unsigned long long>(paths), static_cast<unsigned long long>(points),
                static_cast<unsigned long long>(refused),
                static_cast<unsigned long long>(faster_refused));
    EXPECT_EQ(refused, 0U);
    if (count >= kUsual) {
        EXPECT_GT(10 * faster_refused, 9 * paths) << "too weak to tell anything";
    }
}

}  // namespace
}  // namespace axg::test
