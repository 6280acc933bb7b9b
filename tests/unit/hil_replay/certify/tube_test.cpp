// SPDX-License-Identifier: Apache-2.0
// Boxes around stretches of a path: whole units, hulls of their parts, and the way of a stop.
#include "hil_replay/certify/tube.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/dice.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg {
namespace {

ChordPath random_path(const Machine& machine, std::uint64_t segments, bool has_speeds) {
    test::Dice dice(7);
    ChordPath path;
    path.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    for (std::uint32_t i = 0; i < path.axis_count; ++i) {
        path.delta[i] = 5;
        path.following[i] = 3;
    }
    for (std::uint64_t i = 0; i < (segments + 1) * path.axis_count; ++i) {
        path.nodes.push_back(static_cast<std::int64_t>(dice.in(-1e6, 1e6)));
    }
    path.lines.assign(segments, 1);
    if (has_speeds) {
        for (std::uint64_t i = 0; i < segments * path.axis_count * 2; ++i) {
            path.speeds.push_back(static_cast<std::uint8_t>(dice.in(0, 256)));
        }
    }
    path.runs.push_back({.tool = 0, .segments = segments});
    return path;
}

bool contains(const UnitBox& box, const UnitBox& part, std::uint32_t axes) {
    for (std::uint32_t i = 0; i < axes; ++i) {
        if (part.low[i] < box.low[i] || part.high[i] > box.high[i]) {
            return false;
        }
    }
    return true;
}

// A box is the hull of the boxes of its segments; so both of its ends are those of a part.
TEST(Tube, ABoxIsTheHullOfItsParts) {
    Machine machine = motion_test_machine();
    machine.guard.free_jerk_limited = true;
    const ChordPath path = random_path(machine, 37, true);
    const Tube tube(machine, path);
    test::Dice dice(3);
    for (int k = 0; k < 500; ++k) {
        const auto begin = static_cast<std::uint64_t>(dice.in(0, 37 * 256 - 1));
        const auto end =
            static_cast<std::uint64_t>(dice.in(static_cast<double>(begin) + 1, 37 * 256 + 0.9));
        const UnitBox box = tube.box({begin, end});
        UnitBox hull;
        bool is_first = true;
        for (std::uint64_t at = begin; at < end;) {
            const std::uint64_t next = std::min(end, (at / 256 + 1) * 256);
            const UnitBox part = tube.box({at, next});
            for (std::uint32_t i = 0; i < path.axis_count; ++i) {
                hull.low[i] = is_first ? part.low[i] : std::min(hull.low[i], part.low[i]);
                hull.high[i] = is_first ? part.high[i] : std::max(hull.high[i], part.high[i]);
            }
            is_first = false;
            at = next;
        }
        for (std::uint32_t i = 0; i < path.axis_count; ++i) {
            EXPECT_EQ(box.low[i], hull.low[i]);
            EXPECT_EQ(box.high[i], hull.high[i]);
        }
    }
}

// The point between two parts is in the boxes of both, and each half of a box has its middle.
TEST(Tube, PartsAndHalvesOverlap) {
    Machine machine = motion_test_machine();
    machine.guard.promise = StopPromise::path_keeping;
    const ChordPath path = random_path(machine, 4, false);
    const Tube tube(machine, path);
    for (std::uint64_t at = 1; at < 4 * 256; ++at) {
        const UnitBox before = tube.box({at - 1, at}), after = tube.box({at, at + 1});
        for (std::uint32_t i = 0; i < path.axis_count; ++i) {
            EXPECT_LE(std::max(before.low[i], after.low[i]),
                      std::min(before.high[i], after.high[i]));
        }
    }
    const UnitBox box = tube.box({0, 256});
    const UnitBox low = half_of(box, 0, false), high = half_of(box, 0, true);
    EXPECT_TRUE(contains(box, low, path.axis_count));
    EXPECT_TRUE(contains(box, high, path.axis_count));
    EXPECT_EQ(low.high[0], high.low[0]);
    EXPECT_EQ(low.low[0], box.low[0]);
    EXPECT_EQ(high.high[0], box.high[0]);
}

TEST(Tube, ABoxIsWidenedByBothErrors) {
    Machine machine = motion_test_machine();
    machine.guard.promise = StopPromise::path_keeping;
    const ChordPath path = random_path(machine, 2, false);
    const UnitBox box = Tube(machine, path).box({0, 256});
    for (std::uint32_t i = 0; i < path.axis_count; ++i) {
        EXPECT_EQ(box.low[i], std::min(path.node(0, i), path.node(1, i)) - 8);
        EXPECT_EQ(box.high[i], std::max(path.node(0, i), path.node(1, i)) + 8);
    }
}

TEST(Tube, AnAxisAtRestStaysThereIfItKeepsItsJerk) {
    Machine machine = motion_test_machine();
    machine.guard.free_jerk_limited = true;
    EXPECT_EQ(stop_way(machine, 0, 0), 0);
    machine.guard.stop_reversal = StopReversal::jerk_limited;
    EXPECT_EQ(stop_way(machine, 0, 0), 0);
    machine.guard.free_jerk_limited = false;
    EXPECT_GT(stop_way(machine, 0, 0), 0);  // it may have just begun to accelerate, and turn
    machine.guard.stop_reversal = StopReversal::none;
    EXPECT_EQ(stop_way(machine, 0, 0), 0);
    machine.axes[0].following_error = 0.01;
    EXPECT_GT(stop_way(machine, 0, 0), 0);
}

TEST(Tube, AFasterAxisGoesFarther) {
    for (const bool is_limited : {false, true}) {
        Machine machine = motion_test_machine();
        machine.guard.free_jerk_limited = is_limited;
        double before = 0;
        for (int k = 0; k <= 255; ++k) {
            const double way = stop_way(machine, 0, machine.axes[0].speed_max * k / 255);
            EXPECT_GE(way, before) << k;
            before = way;
        }
        EXPECT_LT(before, 40);
        EXPECT_GT(before, 9);  // v^2 / 2 d
    }
}

TEST(Tube, BoxesAreExactInDouble) {
    const Machine machine = motion_test_machine();
    UnitBox box;
    box.low[0] = -(1LL << 42);
    box.high[0] = (1LL << 42) - 1;
    const JointBox joints = joint_box(machine, box);
    EXPECT_EQ(joints.centre[0], -0x1p-17);
    EXPECT_EQ(joints.centre[0] + joints.half[0], static_cast<double>(box.high[0]) * 0x1p-16);
    EXPECT_EQ(joints.centre[0] - joints.half[0], static_cast<double>(box.low[0]) * 0x1p-16);
}

}  // namespace
}  // namespace axg
