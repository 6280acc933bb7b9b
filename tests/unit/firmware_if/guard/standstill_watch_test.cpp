// SPDX-License-Identifier: Apache-2.0
// From frames to "the axes stand": the look-ahead path, the receiver that begins anew, the rules
// that make the difference, and the machines whose frames can never show it.
#include "firmware_if/guard/standstill_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/support/can_board.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kAhead = 10;

/// A board that sends one sample a millisecond, and who watches it.
struct Board {
    explicit Board(const Machine& made)
        : machine(made),
          encoder(machine),
          watch(machine, {}, standstill_rules(machine), INT64_MIN) {
        snapshot.axis_count = 5;
        snapshot.position = {10, 20, -30, 0.5, 0.25};
        path.position = path.before = snapshot.position;
    }
    /// Whether the axes stand at the end of these samples.
    bool run(int samples) {
        for (int i = 0; i < samples; ++i) {
            snapshot.latched_us += machine.can.sample_us;
            ++snapshot.sample;
            if (moves) {
                moves();
            }
            path.sample = snapshot.sample + machine.can.look_ahead_samples;
            std::vector<CanFrame> frames(kFramesPerSnapshotMax);
            const EncodeResult result = encoder.encode(
                snapshot, frames, machine.can.look_ahead_samples != 0 ? &path : nullptr);
            EXPECT_EQ(result.status, EncodeStatus::ok);
            frames.resize(result.frame_count);
            for (const CanFrame& frame : frames) {
                if (!sends_path && frame.id == machine.can.look_ahead_id) {
                    continue;
                }
                for (StandstillWatch* const each : {&watch, other}) {
                    if (each != nullptr) {
                        each->on_frame(frame);
                    }
                }
            }
        }
        return watch.stands(snapshot.latched_us + machine.can.sample_us);
    }

    Machine machine;
    AxisEncoder encoder;
    StandstillWatch watch;
    StandstillWatch* other = nullptr;
    AxisSnapshot snapshot;
    PathPoints path;
    bool sends_path = true;
    std::function<void()> moves;
};

Machine classical() {
    return test::five_axis_machine(CanFormat::classical);
}

Machine with_path() {
    Machine machine = test::five_axis_machine(CanFormat::fd);
    machine.can.look_ahead_samples = kAhead;
    return machine;
}

TEST(StandstillWatch, AnnouncedPointsThatGoOnAreNoStandstill) {
    Board board(with_path());
    EXPECT_TRUE(board.run(150));
    board.path.position[0] += 0.1;  // commanded, and not begun
    EXPECT_FALSE(board.run(1));
    board.path.before = board.path.position;
    EXPECT_FALSE(board.run(90));
    EXPECT_TRUE(board.run(60)) << "the axes are behind, and they and their commands rest";
}

TEST(StandstillWatch, APathThatEndsSaysNothing) {
    Board board(with_path());
    EXPECT_TRUE(board.run(150));
    board.sends_path = false;
    EXPECT_TRUE(board.run(3)) << "some are lost";
    EXPECT_FALSE(board.run(3));
    EXPECT_FALSE(board.run(300));
    board.sends_path = true;
    EXPECT_TRUE(board.run(150));
}

// The width is in counts of these frames.
TEST(StandstillWatch, ANoiseOfTwoCountsStandsAndOneOfThreeDoesNot) {
    for (const int counts : {2, 3}) {
        Machine machine = classical();
        for (Axis& axis : machine.axes) {
            axis.position_error = 0;
        }
        Board board(machine);
        const double count = board.encoder.frame_set().axes[1].unit;
        const double place = std::round(20 / count);
        board.moves = [&] {
            board.snapshot.position[1] =
                (place + (board.snapshot.sample % 2 == 0 ? counts : 0)) * count;
        };
        EXPECT_EQ(board.run(300), counts == 2);
    }
}

TEST(StandstillWatch, WhatWasLatchedBeforeTheStopDoesNotCount) {
    Board board(classical());
    EXPECT_TRUE(board.run(150));
    board.watch.begin(board.snapshot.latched_us);
    EXPECT_FALSE(board.run(102));
    EXPECT_TRUE(board.run(3));
}

// The receiver gives up, begins anew by itself, and so does the window.
TEST(StandstillWatch, AFaultOfTheReceiverBeginsAnewAndForgets) {
    Board board(classical());
    EXPECT_TRUE(board.run(150));
    CanFrame bus_off;
    bus_off.error = true;
    bus_off.id = 0x040;
    bus_off.time_us = board.snapshot.latched_us + 900;
    board.watch.on_frame(bus_off);
    EXPECT_FALSE(board.watch.stands(board.snapshot.latched_us + 900));
    EXPECT_FALSE(board.run(100));
    EXPECT_TRUE(board.run(50));
}

TEST(StandstillWatch, WithoutAHeartbeatNothingStands) {
    Board board(classical());
    board.machine.can.heartbeat_in_id = 0x7FF;  // of whoever watches; the board keeps its own
    StandstillWatch deaf(board.machine, {}, standstill_rules(board.machine), INT64_MIN);
    board.other = &deaf;
    EXPECT_TRUE(board.run(300));
    EXPECT_FALSE(deaf.stands(board.snapshot.latched_us + 1000));
}

// The rule of before, as an ablation: one frame whose mode is 0.
TEST(StandstillWatch, AModeAloneWouldTakeASwingForStandstill) {
    Board board(classical());
    StandstillRules mode_alone = standstill_rules(board.machine);
    mode_alone.window_samples = 1;
    mode_alone.width.fill(std::numeric_limits<double>::infinity());
    StandstillWatch ablated(board.machine, {}, mode_alone, INT64_MIN);
    board.other = &ablated;
    board.moves = [&board] {  // 125 mm/s, mode 0
        board.snapshot.position[0] =
            10 + 5 * std::sin(25e-6 * static_cast<double>(board.snapshot.latched_us));
    };
    int stood = 0, ablated_stood = 0;
    for (int i = 0; i < 1000; ++i) {
        stood += board.run(1) ? 1 : 0;
        ablated_stood += ablated.stands(board.snapshot.latched_us + 1000) ? 1 : 0;
    }
    EXPECT_EQ(stood, 0);
    EXPECT_GT(ablated_stood, 900) << "the ablation is what the window is for";
}

TEST(StandstillWatch, AMachineThatNeverStandsIsRefusedInWords) {
    EXPECT_EQ(standstill_refusal(classical()), "");
    EXPECT_EQ(standstill_refusal(test::five_axis_machine(CanFormat::signals)), "");
    EXPECT_EQ(standstill_refusal(test::five_axis_machine(CanFormat::cia402)),
              "can.drives: no stop can be confirmed without the velocity of every axis "
              "(missing: Y, Z, A, C). Map object 0x606C and add the key velocity.");
    Machine fast = classical();
    fast.axes[4].speed_max = 2000;
    EXPECT_EQ(standstill_refusal(fast),
              "axes: no stop can be confirmed: an endless axis may turn round between two "
              "samples. Lower its speed_deg_s or can.sample_us.");
}

}  // namespace
}  // namespace axg
