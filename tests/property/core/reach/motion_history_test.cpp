// SPDX-License-Identifier: Apache-2.0
// What positions say about speed and acceleration, against axes that are driven at random and
// sampled badly: errors of position, jitter of the instant, a period that is off, lost samples.
// AXG_COUNT: axes.
#include "core/reach/motion_history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/base/sincos.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

unsigned history_count() {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? 4000U : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

constexpr double kTrackStepS = 2e-5;

/// Position, speed and acceleration every 20 us.
struct Track {
    std::vector<double> position, speed, acceleration;

    [[nodiscard]] std::size_t index(double time_s) const {
        const double at = std::round(time_s / kTrackStepS);
        return std::min(static_cast<std::size_t>(std::max(at, 0.0)), position.size() - 1);
    }
};

/// Long stretches of one jerk, so that errors of all samples can add up one way.
Track drive(Random& random, const Axis& axis, bool jumps, double seconds) {
    Track track;
    double q = between(random, -100, 100), v = between(random, -1, 1) * axis.speed_max, a = 0;
    double until = 0, wanted = 0;
    for (double t = 0; t < seconds; t += kTrackStepS) {
        track.position.push_back(q);
        track.speed.push_back(v);
        track.acceleration.push_back(a);
        if (t >= until) {
            until = t + between(random, 1e-3, 3e-2);
            const double choice = std::clamp(between(random, -1.5, 1.5), -1.0, 1.0);
            wanted = choice * axis.acceleration_max;
        }
        // Not beyond the largest speed: what the acceleration still adds while it falls counts.
        const double settled = v + a * std::fabs(a) / (2 * axis.jerk_max);
        const double room = 0.98 * axis.speed_max;
        double aim = settled > room ? std::min(wanted, 0.0) : wanted;
        aim = settled < -room ? std::max(aim, 0.0) : aim;
        const double step = axis.jerk_max * kTrackStepS;
        const double next = jumps ? aim : std::clamp(aim, a - step, a + step);
        const double start = jumps ? aim : a;
        q += kTrackStepS * (v + kTrackStepS * (start / 3 + next / 6));
        v += 0.5 * (start + next) * kTrackStepS;
        a = next;
    }
    return track;
}

Axis random_axis(Random& random, bool is_unlimited) {
    Axis axis;
    axis.unlimited = is_unlimited;
    axis.kind = is_unlimited ? AxisKind::rotary : AxisKind::linear;
    const double size = is_unlimited ? 0.02 : 1.0;
    axis.speed_max = size * std::exp2(between(random, 5, 10));
    axis.acceleration_max = size * 1000 * std::exp2(between(random, 0, 3.3));
    axis.jerk_max = size * 20000 * std::exp2(between(random, 0, 3.3));
    return axis;
}

struct Worst {
    double speed = 0, acceleration = 0;  // share of the half range that was used
    unsigned judged = 0, tighter = 0;
};

/// The history of a track sampled at its end, and what is really going on there.
void judge_track(Random& random, const Axis& axis, const Track& track, SampleErrors errors,
                 Worst& worst) {
    const double period = errors.period_s * (1 + between(random, -1, 1) * errors.period_share);
    const double end = static_cast<double>(track.position.size() - 1) * kTrackStepS;
    const auto samples = static_cast<std::uint64_t>(40e-3 / errors.period_s);
    const double last = std::floor((end - 2e-3) / kTrackStepS) * kTrackStepS;
    const double bias = between(random, -1, 1);
    MotionHistory history;
    std::size_t now = 0;
    for (std::uint64_t k = 0; k <= samples; ++k) {
        if (k != samples && random() % 16 == 0) {
            continue;  // lost
        }
        const double late = (random() & 1U) != 0 ? 0.5 : between(random, -0.5, 0.5);
        // Between two samples the jitter of both counts: half of it each. Instants of the track.
        const double nominal = last - static_cast<double>(samples - k) * period;
        now = track.index(nominal + late * errors.latch_jitter_s);
        AxisSnapshot snapshot;
        snapshot.sample = k;
        const double error = (random() & 1U) != 0 ? bias : between(random, -1, 1);
        snapshot.position[0] = track.position[now] + error * errors.position;
        if (axis.unlimited) {
            snapshot.position[0] -= 2 * kPi * std::floor(snapshot.position[0] / (2 * kPi));
        }
        note_snapshot(history, snapshot, 1);
    }
    errors.latch_jitter_s += 2 * kTrackStepS;  // instants were rounded to the track's
    const AxisRange range = range_of(history, 0, axis, errors);
    const double v = track.speed[now], a = track.acceleration[now];
    const double slack = 1e-6 * axis.speed_max;
    EXPECT_GE(v, range.speed_low - slack);
    EXPECT_LE(v, range.speed_high + slack);
    EXPECT_GE(a, range.acceleration_low - 1e-6 * axis.acceleration_max);
    EXPECT_LE(a, range.acceleration_high + 1e-6 * axis.acceleration_max);
    ++worst.judged;
    const double wide = 0.5 * (range.speed_high - range.speed_low);
    const double middle = 0.5 * (range.speed_high + range.speed_low);
    worst.speed = std::max(worst.speed, std::fabs(v - middle) / wide);
    const double wide_a = 0.5 * (range.acceleration_high - range.acceleration_low);
    const double middle_a = 0.5 * (range.acceleration_high + range.acceleration_low);
    if (wide_a < 0.99 * axis.acceleration_max) {
        ++worst.tighter;
        worst.acceleration = std::max(worst.acceleration, std::fabs(a - middle_a) / wide_a);
    }
}

void judge_axes(std::uint64_t seed, bool is_limited, bool is_unlimited_axis,
                double jitter_s_most = 1e-4) {
    Random random(printed_seed(seed));
    Worst worst;
    for (unsigned i = 0; i < history_count() && !testing::Test::HasFailure(); ++i) {
        const Axis axis = random_axis(random, is_unlimited_axis);
        SampleErrors errors;
        errors.period_s = (random() & 1U) != 0 ? 1e-3 : 2e-3;
        errors.period_share = 0.01;
        errors.latch_jitter_s = between(random, 0, jitter_s_most);
        errors.position = (is_unlimited_axis ? 2e-5 : 1e-3) * between(random, 0, 2);
        errors.is_jerk_limited = is_limited;
        const Track track = drive(random, axis, !is_limited, 0.05);
        judge_track(random, axis, track, errors, worst);
    }
    std::printf(
        "%u axes, %u with an acceleration better than its limit; at most %.2f of the range "
        "of speeds and %.2f of that of accelerations was used\n",
        worst.judged, worst.tighter, worst.speed, worst.acceleration);
    if (history_count() >= 4000 && jitter_s_most <= 1e-4) {
        EXPECT_GT(worst.speed, 0.5) << "a bound this wide would hide a missing term";
        EXPECT_TRUE(!is_limited || worst.tighter > worst.judged / 4);
    }
}

TEST(MotionHistory, SpeedIsWithinItsRangeWhereAccelerationJumps) {
    judge_axes(20261160, false, false);
}
TEST(MotionHistory, SpeedAndAccelerationAreWithinTheirRangesWhereJerkIsLimited) {
    judge_axes(20261161, true, false);
}
// As positions of different ages: two periods of jitter.
TEST(MotionHistory, AJitterOfPeriodsIsWithinTheRangesToo) {
    judge_axes(20261163, true, false, 2e-3);
}
TEST(MotionHistory, AnEndlessAxisIsFollowedAcrossTheTurn) {
    judge_axes(20261162, true, true);
}

Axis slow_axis() {
    Axis axis;
    axis.speed_max = 500;
    axis.acceleration_max = 4000;
    axis.jerk_max = 50000;
    return axis;
}

AxisSnapshot at(std::uint64_t sample, double position) {
    AxisSnapshot snapshot;
    snapshot.sample = sample;
    snapshot.position[0] = position;
    return snapshot;
}

constexpr SampleErrors kGood{.period_s = 1e-3,
                             .period_share = 0,
                             .latch_jitter_s = 0,
                             .position = 0.001,
                             .is_jerk_limited = false};

TEST(MotionHistory, OneSnapshotSaysNothing) {
    MotionHistory history;
    note_snapshot(history, at(7, 12), 1);
    const AxisRange range = range_of(history, 0, slow_axis(), kGood);
    EXPECT_EQ(range.speed_low, -500);
    EXPECT_EQ(range.speed_high, 500);
    EXPECT_EQ(range.acceleration_high, 4000);
    EXPECT_NEAR(range.low, 11.999, 1e-8);
    EXPECT_NEAR(range.high, 12.001, 1e-8);
}

// dq/dt +- (a dt/2 + 2e/dt), by hand: 0.1 mm in 1 ms, 4000 mm/s2, 1 um: 100 +- (2 + 2).
TEST(MotionHistory, TwoSnapshotsGiveTheMeanAndWhatMayHaveChangedSince) {
    MotionHistory history;
    note_snapshot(history, at(7, 12), 1);
    note_snapshot(history, at(8, 12.1), 1);
    AxisRange range = range_of(history, 0, slow_axis(), kGood);
    EXPECT_NEAR(range.speed_low, 96, 1e-3);
    EXPECT_NEAR(range.speed_high, 104, 1e-3);
    SampleErrors jittery = kGood;
    jittery.latch_jitter_s = 5e-5;  // 0.102 / 0.95 ms + 2.1, and 0.098 / 1.05 ms - 2.1
    range = range_of(history, 0, slow_axis(), jittery);
    EXPECT_NEAR(range.speed_low, 0.098 / 1.05e-3 - 2.1, 1e-3);
    EXPECT_NEAR(range.speed_high, 0.102 / 0.95e-3 + 2.1, 1e-3);
}

// An axis that braked at 4000 mm/s2 for 16 ms comes to rest now: it passed the oldest sample at 64
// mm/s, so 50 us of jitter moved that one by 3.2 um, and the one in between by 1.6. The speed of
// now, next to none, would explain a fraction of it.
TEST(MotionHistory, JitterMovesAnOlderSampleByTheSpeedOfThen) {
    SampleErrors jittery = kGood;
    jittery.latch_jitter_s = 1e-4;
    jittery.position = 0;
    jittery.is_jerk_limited = true;
    Axis axis = slow_axis();
    axis.acceleration_max = 8000;
    axis.jerk_max = 1;  // the acceleration was the same all the time
    for (const double way : {1.0, -1.0}) {
        MotionHistory history;
        for (std::uint64_t k = 0; k <= 16; ++k) {
            const double late_s = k == 0 ? -5e-5 : k == 8 ? 5e-5 : 0;
            const double before_s = (16 - static_cast<double>(k)) * 1e-3 - way * late_s;
            note_snapshot(history, at(k, -0.5 * 4000 * before_s * before_s), 1);
        }
        const AxisRange range = range_of(history, 0, axis, jittery);
        EXPECT_LT(range.acceleration_high - range.acceleration_low, 2000) << "no bound at all";
        EXPECT_LE(range.acceleration_low, -4000);
        EXPECT_GE(range.acceleration_high, -4000);
    }
}

// Three samples lost: 0.4 mm in 4 ms, 100 +- (8 + 0.5).
TEST(MotionHistory, LostSamplesWidenTheRange) {
    MotionHistory history;
    note_snapshot(history, at(7, 12), 1);
    note_snapshot(history, at(11, 12.4), 1);
    const AxisRange range = range_of(history, 0, slow_axis(), kGood);
    EXPECT_NEAR(range.speed_low, 91.5, 1e-3);
    EXPECT_NEAR(range.speed_high, 108.5, 1e-3);
}

// A promise that is broken says nothing any more: 600 mm/s, then standstill a millisecond later.
TEST(MotionHistory, SnapshotsThatContradictThePromisesSayNothing) {
    MotionHistory history;
    note_snapshot(history, at(7, 12), 1);
    note_snapshot(history, at(8, 12.4), 1);
    note_snapshot(history, at(9, 12.4), 1);
    const AxisRange range = range_of(history, 0, slow_axis(), kGood);
    EXPECT_EQ(range.speed_low, -500);
    EXPECT_EQ(range.speed_high, 500);
}

TEST(MotionHistory, ASampleThatIsNotNewerBeginsAnew) {
    MotionHistory history;
    note_snapshot(history, at(7, 12), 1);
    note_snapshot(history, at(8, 12.1), 1);
    note_snapshot(history, at(8, 12.1), 1);
    EXPECT_EQ(history.count, 1U);
}

// With a stride of ten the history spans sixteen strides, and the newest is always the newest.
TEST(MotionHistory, CloseSamplesReplaceEachOther) {
    MotionHistory history;
    for (std::uint64_t k = 0; k <= 400; ++k) {
        note_snapshot(history, at(k, 0.01 * static_cast<double>(k)), 10);
        EXPECT_EQ(history.sample[0], k);
    }
    EXPECT_EQ(history.count, kSamplesKept);
    EXPECT_EQ(history.sample[1], 390U);
    EXPECT_EQ(history.sample[16], 240U);
}

}  // namespace
}  // namespace axg::test
