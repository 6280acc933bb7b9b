// SPDX-License-Identifier: Apache-2.0
// The path of chords: every sample is near its chord, speeds hold for as long as they have to, and
// every tool counts around a change.
#include "hil_replay/certify/chord_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/reach/stop_limits.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg {
namespace {

constexpr double kRateMmS = 100;

/// Samples of a circle of 20 mm in X and Y, then of a straight line in Z.
std::vector<MotionSample> bent_motion() {
    std::vector<MotionSample> out;
    for (std::uint64_t k = 0; k < 8000; ++k) {
        const double s = static_cast<double>(std::min<std::uint64_t>(k, 4000)) * 0.01;
        const double z = static_cast<double>(k - std::min<std::uint64_t>(k, 4000)) * 0.01;
        MotionSample sample{.index = k, .line = k <= 4000 ? 7U : 8U, .tool = 1};
        sample.position = {20 * std::cos(s / 20), 20 * std::sin(s / 20), -z};
        out.push_back(sample);
    }
    return out;
}

ChordPath thinned(const Machine& machine, const std::vector<MotionSample>& samples,
                  const ChordOptions& options = {}) {
    PathThinner thinner(machine, options);
    for (const MotionSample& sample : samples) {
        thinner.add(sample, 0);
    }
    return thinner.finish();
}

/// Distance of a position from the chord of a segment, each axis in shares of its tolerance.
double off_chord(const Machine& machine, const ChordPath& path, std::uint64_t segment,
                 const AxisPositions& p) {
    AxisPositions from{}, way{};
    std::uint32_t widest = 0;
    for (std::uint32_t i = 0; i < path.axis_count; ++i) {
        const double unit = unit_of(machine.axes[i].kind);
        from[i] = static_cast<double>(path.node(segment, i)) * unit;
        way[i] = static_cast<double>(path.node(segment + 1, i)) * unit - from[i];
        widest = std::fabs(way[i]) > std::fabs(way[widest]) ? i : widest;
    }
    const double along = std::clamp((p[widest] - from[widest]) / way[widest], 0.0, 1.0);
    double worst = 0;
    for (std::uint32_t i = 0; i < path.axis_count; ++i) {
        const double unit = unit_of(machine.axes[i].kind);
        const double off = std::fabs(p[i] - (from[i] + along * way[i]));
        worst = std::max(worst, off / (static_cast<double>(path.delta[i]) * unit));
    }
    return worst;
}

TEST(ChordPath, EverySampleIsNearTheChordsInTurn) {
    Machine machine = motion_test_machine();
    machine.guard.promise = StopPromise::path_keeping;  // so that chords are long
    const std::vector<MotionSample> samples = bent_motion();
    const ChordPath path = thinned(machine, samples);
    EXPECT_LT(path.segment_count(), 64U);
    EXPECT_GT(path.segment_count(), 10U);
    EXPECT_TRUE(path.speeds.empty());
    std::uint64_t segment = 0;
    for (const MotionSample& sample : samples) {
        while (off_chord(machine, path, segment, sample.position) > 1) {
            ++segment;
            ASSERT_LT(segment, path.segment_count()) << sample.index;
        }
    }
    EXPECT_EQ(segment + 1, path.segment_count());
    EXPECT_EQ(path.lines.front(), 7U);
    EXPECT_EQ(path.lines.back(), 8U);
}

TEST(ChordPath, ASmallerToleranceNeedsMoreChords) {
    Machine machine = motion_test_machine();
    machine.guard.promise = StopPromise::path_keeping;
    ChordOptions fine;
    fine.delta_mm = 0.001;
    EXPECT_GT(thinned(machine, bent_motion(), fine).segment_count(),
              2 * thinned(machine, bent_motion()).segment_count());
}

// Of a board that keeps its jerk: a segment has the speeds of a / j seconds after it, too.
TEST(ChordPath, SpeedsLookAhead) {
    Machine machine = motion_test_machine();
    machine.guard.free_jerk_limited = true;
    std::vector<MotionSample> samples;
    const std::uint64_t slow_until = 3000;
    double x = 0;
    for (std::uint64_t k = 0; k < 4000; ++k) {
        MotionSample sample{.index = k, .line = 1};
        x += k == 0 ? 0 : (k <= slow_until ? 10 : kRateMmS) * kMotionStepS;
        sample.position[0] = x;
        samples.push_back(sample);
    }
    const ChordPath path = thinned(machine, samples);
    const Axis& axis = machine.axes[0];
    const double step = axis.speed_max / kSpeedSteps;
    const double ahead_mm = 10 * axis.acceleration_max / axis.jerk_max;
    for (std::uint64_t i = 0; i < path.segment_count(); ++i) {
        const double end = static_cast<double>(path.node(i + 1, 0)) * unit_of(axis.kind);
        const double until_fast = static_cast<double>(slow_until) * 10 * kMotionStepS - end;
        const double up = path.speeds[i * path.axis_count * 2] * step;
        EXPECT_GE(up, until_fast < ahead_mm ? kRateMmS : 10) << i;
        if (until_fast > 2 * ahead_mm) {
            EXPECT_LE(up, 10 + 0.5 * axis.acceleration_max * kMotionStepS + step) << i;
        }
        EXPECT_LE(path.speeds[i * path.axis_count * 2 + 1], 0) << i;    // never back
        EXPECT_EQ(path.speeds[(i * path.axis_count + 1) * 2], 0) << i;  // Y rests
    }
}

TEST(ChordPath, WithoutAPromisedJerkNothingLooksAhead) {
    const Machine machine = motion_test_machine();
    std::vector<MotionSample> samples;
    for (std::uint64_t k = 0; k < 2000; ++k) {
        MotionSample sample{.index = k, .line = 1};
        sample.position[0] = k < 1000 ? 0 : static_cast<double>(k - 1000) * 0.01;
        sample.position[1] = k < 1000 ? static_cast<double>(k) * 0.001 : 0.999;
        samples.push_back(sample);
    }
    const ChordPath path = thinned(machine, samples);
    EXPECT_EQ(path.speeds[0], 0);  // X, which begins to move later
    EXPECT_GT(path.speeds[2], 0);
}

TEST(ChordPath, EveryToolCountsAroundAChange) {
    Machine machine = motion_test_machine();
    machine.axes.resize(3);  // equal ones
    std::vector<MotionSample> samples = bent_motion();
    PathThinner thinner(machine, {});
    const std::uint64_t change = 4000;
    for (const MotionSample& sample : samples) {
        thinner.add(sample, sample.index < change ? 0 : 1);
    }
    const ChordPath path = thinner.finish();
    ASSERT_EQ(path.runs.size(), 2U);
    EXPECT_EQ(path.runs[0].tool, 0U);
    EXPECT_EQ(path.runs[1].tool, 1U);
    EXPECT_EQ(path.runs[0].first, 0U);
    EXPECT_EQ(path.runs[1].last, 0U);
    // Before: the longest permit. After: that, and the longest stop.
    const double free_s = free_seconds(machine, machine.can.permit_samples.most);
    const double stop_s =
        (2000.0 + 1500) / 50000 + machine.axes[0].speed_max / machine.axes[0].stopping_min;
    const double segment_s = 100 * kMotionStepS;
    EXPECT_GE(static_cast<double>(path.runs[0].last) * segment_s, free_s);
    EXPECT_GE(static_cast<double>(path.runs[1].first) * segment_s, free_s + stop_s);
    EXPECT_LT(path.runs[1].first, path.runs[1].segments);
}

TEST(ChordPath, AProgramWithAnUnknownToolHasNoPath) {
    const Machine machine = motion_test_machine();
    Program program;
    program.start_tool = 1;
    Move move;
    move.kind = MoveKind::tool_change;
    move.tool = 99;
    move.line = 4;
    program.moves.push_back(move);
    const PlannedPath planned = plan_chord_path(machine, program, {}, {}, {});
    EXPECT_EQ(planned.unknown_tool, 99U);
    EXPECT_EQ(planned.unknown_line, 4U);
    EXPECT_EQ(planned.path.segment_count(), 0U);
}

}  // namespace
}  // namespace axg
