// SPDX-License-Identifier: Apache-2.0
// Goal: no drive, and no stop of it, leaves the tube of its program, for each promise. Method:
// random programs; at random instants a stop begins, with errors of every kind at their largest or
// at random; the whole stop has to lie in the box of the segment in which it began. Ablations: a
// tube without the way of a stop, without the following error or without the tolerance of the
// chords is left by some.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "hil_replay/certify/tube.hpp"
#include "tests/support/count.hpp"
#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

const std::uint64_t kSeed = test::printed_seed(56);

struct Drive {
    Machine machine;
    std::vector<MotionSample> samples;
    ChordPath path;
    std::vector<std::uint64_t> segment;  // [samples] that a sample belongs to
};

Program random_program(const Machine& machine, test::Dice& dice) {
    Program program;
    program.start_tool = 1;
    for (int k = 0; k < 12; ++k) {
        Move move;
        move.line = static_cast<std::uint32_t>(k) + 1;
        const bool is_rapid = dice.chance(0.4);
        move.feed_kind = is_rapid ? FeedKind::rapid : FeedKind::per_minute;
        move.feed = dice.magnitude(100, 9000);
        const double size = dice.magnitude(0.05, 60);
        const AxisPositions from = k == 0 ? program.start : program.moves.back().target;
        for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
            const double scale = machine.axes[i].kind == AxisKind::rotary ? kTestRadPerDegree : 1;
            move.target[i] = from[i] + (dice.chance(0.3) ? 0 : dice.in(-size, size) * scale);
        }
        program.moves.push_back(move);
    }
    return program;
}

/// @param error  following error, mm; rotary axes have a hundredth of it, rad
Drive random_drive(bool keeps_jerk, StopPromise promise, double error, test::Dice& dice) {
    Drive out;
    out.machine = motion_test_machine();
    out.machine.guard.free_jerk_limited = keeps_jerk;
    out.machine.guard.promise = promise;
    for (Axis& axis : out.machine.axes) {
        axis.following_error = axis.kind == AxisKind::linear ? error : error / 100;
    }
    const Program program = random_program(out.machine, dice);
    const MotionLimits limits = make_motion_limits(out.machine);
    const MotionOptions options;
    MotionSampler sampler(program, limits, options);
    PathThinner thinner(out.machine, {});
    MotionSample sample;
    while (sampler.next(sample)) {
        thinner.add(sample, 0);
        out.samples.push_back(sample);
    }
    out.path = thinner.finish();
    return out;
}

/// The segment of the motion from each sample on; every sample lies in its segment's box.
void find_segments(Drive& drive) {
    Machine plain = drive.machine;
    plain.guard.promise = StopPromise::path_keeping;
    ChordPath exact = drive.path;
    exact.following.fill(0);
    const Tube tube(plain, exact);
    std::uint64_t at = 0;
    for (const MotionSample& sample : drive.samples) {
        while (at + 1 < exact.segment_count() && exact.ends[at] <= sample.index) {
            ++at;
        }
        const JointBox box = joint_box(plain, tube.box({at * 256, (at + 1) * 256}));
        for (std::size_t i = 0; i < plain.axes.size(); ++i) {
            EXPECT_LE(std::fabs(sample.position[i] - box.centre[i]), box.half[i]) << sample.index;
        }
        drive.segment.push_back(at);
    }
}

/// How far an axis gets that brakes from this speed and acceleration, by steps of constant jerk.
double braking_way(const Axis& axis, double speed, double acceleration, double stopping) {
    constexpr double kStep = 2e-5;
    double way = 0;
    while (speed > 0) {
        const double next = std::max(-stopping, acceleration - axis.jerk_max * kStep);
        const double mean = 0.5 * (acceleration + next);
        way += speed * kStep + mean * kStep * kStep / 2;
        speed += mean * kStep;
        acceleration = next;
    }
    return way;
}

/// The largest speed of an axis one way, from a sample on, for as long as its jerk may need.
double speed_ahead(const Drive& drive, std::uint64_t from, std::uint32_t axis, double sign) {
    const Axis& of = drive.machine.axes[axis];
    const auto steps = static_cast<std::uint64_t>(of.acceleration_max / of.jerk_max / kMotionStepS);
    double most = 0;
    for (std::uint64_t k = from; k + 1 < drive.samples.size() && k <= from + steps; ++k) {
        const double way = drive.samples[k + 1].position[axis] - drive.samples[k].position[axis];
        most = std::max(most, sign * way / kMotionStepS);
    }
    return most;
}

struct Tally {
    std::uint64_t outside = 0;
    double worst = 0;  // share of the room beyond chord and errors that a stop used
};

/// One stop of all axes, each by itself.
void stop_once(const Drive& drive, const JointBox& box, std::uint64_t from, test::Dice& dice,
               Tally& tally) {
    const double feed = dice.chance(0.3) ? 1 : dice.in(0, 1);
    bool is_outside = false;
    for (std::uint32_t i = 0; i < drive.machine.axes.size(); ++i) {
        const Axis& axis = drive.machine.axes[i];
        const std::size_t next = std::min(from + 1, drive.samples.size() - 1);
        const double command = drive.samples[from].position[i];
        const double step = drive.samples[next].position[i] - command;
        const double sign = step != 0 ? std::copysign(1.0, step) : dice.chance(0.5) ? 1 : -1;
        const double f = axis.following_error, a = axis.acceleration_max, j = axis.jerk_max;
        const double off = dice.chance(0.5) ? f : dice.in(-f, f);
        const double swing = 2 * std::sqrt(a * (f - off));
        const double ahead =
            std::min(axis.speed_max, speed_ahead(drive, from, i, sign) + 2 * std::sqrt(2 * a * f));
        const double speed =
            std::min(feed * sign * step / kMotionStepS + dice.in(0, 1) * swing, ahead);
        const double room =
            drive.machine.guard.free_jerk_limited ? ahead - speed : axis.speed_max - speed;
        const double most = std::min(a, std::sqrt(2 * j * std::max(0.0, room)));
        const double acceleration = dice.chance(0.5) ? most : dice.in(-a, most);
        const double stopping = axis.stopping_min * (dice.chance(0.5) ? 1 : dice.in(1, 3));
        const double begin = command + sign * off;
        const double end = begin + sign * braking_way(axis, speed, acceleration, stopping);
        const double far =
            std::max(std::fabs(begin - box.centre[i]), std::fabs(end - box.centre[i]));
        is_outside = is_outside || !(far <= box.half[i]);
        tally.worst = std::max(tally.worst, far / box.half[i]);
    }
    tally.outside += is_outside ? 1 : 0;
}

enum class Without : std::uint8_t { nothing, stop, following, tolerance };

/// @param stops  of all programs
Tally drive_and_stop(bool keeps_jerk, double error, Without without, std::uint64_t stops) {
    test::Dice dice(kSeed);
    Tally tally;
    constexpr std::uint64_t kStopsOfProgram = 500;
    for (std::uint64_t done = 0; done < stops; done += kStopsOfProgram) {
        Drive drive = random_drive(keeps_jerk, StopPromise::independent, error, dice);
        find_segments(drive);
        Machine judged = drive.machine;
        ChordPath path = drive.path;
        if (without == Without::stop) {
            judged.guard.promise = StopPromise::path_keeping;
        }
        if (without == Without::following) {
            path.following.fill(0);
            for (Axis& axis : judged.axes) {
                axis.following_error = 0;
            }
        }
        if (without == Without::tolerance) {
            path.delta.fill(0);
        }
        const Tube tube(judged, path);
        for (std::uint64_t k = 0; k < std::min(kStopsOfProgram, stops); ++k) {
            const auto from = static_cast<std::uint64_t>(
                dice.in(0, static_cast<double>(drive.samples.size()) - 1));
            const std::uint64_t at = drive.segment[from];
            stop_once(drive, joint_box(judged, tube.box({at * 256, (at + 1) * 256})), from, dice,
                      tally);
        }
    }
    return tally;
}

TEST(TubeDrives, NoIndependentStopLeavesTheTube) {
    const std::uint64_t stops = test::count_from_environment(10000, 1000);
    for (const bool keeps_jerk : {true, false}) {
        for (const double error : {0.0, 0.02}) {
            const Tally tally = drive_and_stop(keeps_jerk, error, Without::nothing, stops);
            EXPECT_EQ(tally.outside, 0U) << keeps_jerk << ' ' << error;
            EXPECT_GT(tally.worst, 0.95) << keeps_jerk << ' ' << error;
            EXPECT_LE(tally.worst, 1);
        }
    }
}

TEST(TubeDrives, WithoutTheWayOfAStopSomeLeaveIt) {
    EXPECT_GT(drive_and_stop(true, 0, Without::stop, 1000).outside, 0U);
    EXPECT_GT(drive_and_stop(false, 0, Without::stop, 1000).outside, 0U);
}

TEST(TubeDrives, WithoutTheFollowingErrorSomeLeaveIt) {
    EXPECT_GT(drive_and_stop(true, 0.02, Without::following, 1000).outside, 0U);
}

/// Positions during stops along the path: within the following error of some command.
std::uint64_t leave_path(double error, Without without, std::uint64_t positions) {
    test::Dice dice(kSeed);
    std::uint64_t outside = 0;
    for (std::uint64_t done = 0; done < positions; done += 1000) {
        Drive drive = random_drive(false, StopPromise::path_keeping, error, dice);
        find_segments(drive);
        ChordPath path = drive.path;
        if (without == Without::following) {
            path.following.fill(0);
        }
        if (without == Without::tolerance) {
            path.delta.fill(0);
        }
        const Tube tube(drive.machine, path);
        for (int k = 0; k < 1000; ++k) {
            const auto at = static_cast<std::uint64_t>(
                dice.in(0, static_cast<double>(drive.samples.size()) - 1));
            const std::uint64_t segment = drive.segment[at];
            const JointBox box =
                joint_box(drive.machine, tube.box({segment * 256, (segment + 1) * 256}));
            bool is_outside = false;
            for (std::uint32_t i = 0; i < drive.machine.axes.size(); ++i) {
                const double f = drive.machine.axes[i].following_error;
                const double position = drive.samples[at].position[i] + dice.in(-f, f);
                is_outside = is_outside || !(std::fabs(position - box.centre[i]) <= box.half[i]);
            }
            outside += is_outside ? 1 : 0;
        }
    }
    return outside;
}

TEST(TubeDrives, NoStopAlongThePathLeavesTheTube) {
    const std::uint64_t positions = test::count_from_environment(10000, 1000);
    EXPECT_EQ(leave_path(0, Without::nothing, positions), 0U);
    EXPECT_EQ(leave_path(0.02, Without::nothing, positions), 0U);
    EXPECT_GT(leave_path(0.02, Without::following, 1000), 0U);
    EXPECT_GT(leave_path(0, Without::tolerance, 1000), 0U);
}

}  // namespace
}  // namespace axg
