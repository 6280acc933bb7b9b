// SPDX-License-Identifier: Apache-2.0
// Frames of other makers in every form a DBC file can describe: floats, pages of one message,
// states and counters. What a board says must be what the receiver hands out, and nothing else.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware_if/protocol/signal_frames.hpp"
#include "firmware_if/protocol/wire.hpp"
#include "tests/support/dbc_text.hpp"
#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

Machine machine_of(const std::string& text) {
    Machine machine;
    EXPECT_EQ(faults_with_file(text, kBoardDbc, machine), "");
    return machine;
}

AxisSnapshot snapshot_of(std::uint64_t k) {
    AxisSnapshot snapshot;
    snapshot.latched_us = 1'000'000 + static_cast<std::int64_t>(k) * 1000;
    snapshot.sample = k;
    snapshot.axis_count = 3;
    snapshot.tool = 2;
    snapshot.mode = kModeMoving;
    const auto t = static_cast<double>(k) * 1e-3;
    snapshot.position = {10 * t, -0.3 * t, 2 * t};
    return snapshot;
}

struct Board {
    Machine machine;
    AxisEncoder encoder{machine};
    AxisReceiver receiver{machine};
    Heard heard;

    explicit Board(const std::string& text) : machine(machine_of(text)) {}

    /// Sends sample k as `change` leaves it.
    template <class Change>
    void send(std::uint64_t k, Change change) {
        std::vector<CanFrame> frames = frames_of(encoder, snapshot_of(k));
        change(frames);
        listen(receiver, frames, heard);
    }
    void send(std::uint64_t k) {
        send(k, [](std::vector<CanFrame>&) {});
    }
    [[nodiscard]] std::uint64_t count(ReceiverFault fault) const {
        return receiver.counters().of(fault);
    }
};

TEST(SignalReceiver, WhatADbcDescribesArrivesAsItWasSent) {
    Board board(dbc_machine());
    for (std::uint64_t k = 0; k < 600; ++k) {  // past every wrap: 15, 256 and both together
        board.send(k);
    }
    EXPECT_TRUE(board.heard.faults.empty()) << fault_row(board.heard.faults.front().fault).name;
    ASSERT_EQ(board.heard.snapshots.size(), 600U);
    for (std::uint64_t k = 0; k < 600; ++k) {
        const AxisSnapshot& got = board.heard.snapshots[k];
        const AxisSnapshot sent = snapshot_of(k);
        EXPECT_NEAR(got.position[0], sent.position[0], 0.51e-4);
        EXPECT_EQ(static_cast<float>(got.position[1]), static_cast<float>(sent.position[1]));
        EXPECT_NEAR(got.position[2], sent.position[2], 1e-9);
        EXPECT_EQ(got.tool, 2);
        EXPECT_EQ(got.mode, kModeMoving);
        EXPECT_EQ(got.flags, 0);
    }
}

// Tilt is 0x181 of 29 bits, and Linear is 0x181 of 11.
TEST(SignalReceiver, IdentifiersOf29BitsAreOthersThanOf11) {
    Machine machine;
    ASSERT_EQ(faults_with_file(dbc_machine(),
                               with(with(kBoardDbc, "BO_ 386 Tilt", "BO_ 2147484033 Tilt"),
                                    "SIG_VALTYPE_ 386", "SIG_VALTYPE_ 2147484033"),
                               machine),
              "");
    AxisEncoder encoder(machine);
    AxisReceiver receiver(machine);
    Heard heard;
    for (std::uint64_t k = 0; k < 40; ++k) {
        std::vector<CanFrame> frames = frames_of(encoder, snapshot_of(k));
        ASSERT_EQ(frames.size(), 2U);
        EXPECT_FALSE(frames[0].extended);
        EXPECT_TRUE(frames[1].extended);
        EXPECT_EQ(frames[1].id, 0x181U);
        CanFrame other = frames[1];  // the same number and low bits, of a board that is not ours
        other.id |= 0x18FF0000U;
        frames.push_back(other);
        listen(receiver, frames, heard);
    }
    ASSERT_EQ(heard.snapshots.size(), 40U);
    for (std::uint64_t k = 0; k < 40; ++k) {
        EXPECT_NEAR(heard.snapshots[k].position[0], snapshot_of(k).position[0], 0.51e-4);
        EXPECT_NEAR(heard.snapshots[k].position[2], snapshot_of(k).position[2], 1e-9);
    }
    EXPECT_EQ(receiver.counters().of(ReceiverFault::extended_id), 40U);
    EXPECT_EQ(heard.faults.size(), 40U);
    // Of the other kind it is no frame of ours at all.
    std::vector<CanFrame> swapped = frames_of(encoder, snapshot_of(40));
    swapped[0].extended = true;
    EXPECT_EQ(slot_of(encoder.frame_set(), swapped[0]), 1U);
    swapped[1].extended = false;
    EXPECT_EQ(slot_of(encoder.frame_set(), swapped[1]), 0U);
    swapped[1].id |= 0x80000000U;
    EXPECT_EQ(slot_of(encoder.frame_set(), swapped[1]), 2U) << "bit 31 is no part of a number";
}

/// X and A in pages 0 and 4 to 6, and in page 3 of page 1.
Machine multiplexed_machine() {
    const std::string file = with(kBoardDbc, " SG_ P1 m1 : 8|32@1-", " SG_ P1 m3 : 16|32@1-");
    const std::string pages =
        with(with(file, "Deep m2M : 8|8", "Deep m1M : 8|8"), "P0 Page 0-0", "P0 Page 4-6, 0-0");
    std::string text = with(dbc_machine(), "X: Linear.X", "X: Pages.P0");
    text = with(text, "A: Tilt.A", "A: Pages.P1");
    Machine machine;
    EXPECT_EQ(faults_with_file(text,
                               with(with(pages, "Deep Page 2-2", "Deep Page 1-1"), "P1 Page 1 - 1",
                                    "P1 Deep 3-3"),
                               machine),
              "");
    return machine;
}

// A frame is of a page if each multiplexor has one of the page's values. The position of another
// page is not taken, and one that comes no more ends the set.
TEST(SignalReceiver, APositionIsReadUnderAnyOfItsValuesAndUnderNoOther) {
    const Machine machine = multiplexed_machine();
    AxisEncoder encoder(machine);
    const std::uint32_t x = slot_of(encoder.frame_set(), frames_of(encoder, snapshot_of(0))[0]);
    CanFrame frame = frames_of(encoder, snapshot_of(1))[0];
    ASSERT_EQ(frame.id, 400U);
    for (std::uint32_t page = 0; page < 256; ++page) {
        for (const std::uint32_t deep : {0U, 2U, 3U, 4U, 255U}) {
            frame.data[0] = static_cast<std::uint8_t>(page);
            frame.data[1] = static_cast<std::uint8_t>(deep);
            const bool is_x = page == 0 || (page >= 4 && page <= 6);
            const bool is_a = page == 1 && deep == 3;
            const std::uint32_t slot = slot_of(encoder.frame_set(), frame);
            EXPECT_EQ(slot == x, is_x) << page;
            EXPECT_EQ(slot < encoder.frame_set().frame_count, is_x || is_a) << page << ' ' << deep;
        }
    }
}

TEST(SignalReceiver, APageThatComesNoMoreEndsTheSamples) {
    const Machine machine = multiplexed_machine();
    AxisEncoder encoder(machine);
    AxisReceiver receiver(machine);
    Heard heard;
    for (std::uint64_t k = 0; k < 60; ++k) {
        std::vector<CanFrame> frames = frames_of(encoder, snapshot_of(k));
        for (CanFrame& frame : frames) {
            if (frame.id == 400 && frame.data[0] == 0) {
                // The board takes turns; from sample 40 on it sends a page that is not X's.
                frame.data[0] = static_cast<std::uint8_t>(k < 40 ? std::array{0, 4, 6}[k % 3] : 7);
            }
        }
        listen(receiver, frames, heard);
    }
    ASSERT_EQ(heard.snapshots.size(), 40U);
    for (std::uint64_t k = 0; k < 40; ++k) {
        EXPECT_NEAR(heard.snapshots[k].position[0], snapshot_of(k).position[0], 0.51e-3) << k;
        EXPECT_NEAR(heard.snapshots[k].position[1], snapshot_of(k).position[1], 1e-5) << k;
    }
    EXPECT_FALSE(heard.faults.empty());
    EXPECT_EQ(receiver.state(), ReceiverState::invalid);
}

TEST(SignalReceiver, StatesShareTheirBitsAndMeanOneValueEach) {
    for (const auto& [state, mode] :
         {std::pair{0, kModeStandstill}, std::pair{1, kModeMoving}, std::pair{2, kModeToolChange},
          std::pair{3, kModeStandstill}}) {
        Board board(dbc_machine());
        for (std::uint64_t k = 0; k < 3; ++k) {
            board.send(k, [state = state](std::vector<CanFrame>& frames) {
                frames[0].data[5] = static_cast<std::uint8_t>(state);
            });
        }
        ASSERT_EQ(board.heard.snapshots.size(), 3U);
        EXPECT_EQ(board.heard.snapshots[2].mode, mode) << state;
    }
}

TEST(SignalReceiver, ABoardThatIsNotHomedStops) {
    Board board(dbc_machine());
    board.send(0);
    board.send(1, [](std::vector<CanFrame>& frames) { frames[0].data[7] = 0; });
    EXPECT_EQ(board.receiver.stop_cause(), ReceiverFault::not_homed);
}

TEST(SignalReceiver, CountersFindRepetitionLossAndASecondSender) {
    Board board(dbc_machine());
    for (std::uint64_t k = 0; k < 40; ++k) {  // past the wrap from 14 to 0
        board.send(k);
    }
    EXPECT_TRUE(board.heard.faults.empty());
    CanFrame last;
    board.send(40, [&](std::vector<CanFrame>& frames) {
        frames.insert(frames.begin() + 1, frames[0]);
        last = frames[0];
    });
    EXPECT_EQ(board.count(ReceiverFault::repeated), 1U);
    EXPECT_EQ(board.receiver.state(), ReceiverState::valid);
    last.time_us += 600;
    last.data[0] ^= 1U;
    listen(board.receiver, {last}, board.heard);
    EXPECT_EQ(board.receiver.stop_cause(), ReceiverFault::spoofed);

    Board fifteen(dbc_machine());
    fifteen.send(0, [](std::vector<CanFrame>& frames) {
        frames[0].data[4] = 15;  // a count that the range does not have
    });
    EXPECT_EQ(fifteen.count(ReceiverFault::bad_format), 1U);
    EXPECT_TRUE(fifteen.heard.snapshots.empty());
}

// A frame that is half a turn late would pass for a few that were lost.
TEST(SignalReceiver, ACounterOfThreeBitsBearsThreeSteps) {
    for (const std::uint64_t lost : {2U, 3U}) {
        Machine machine;
        ASSERT_EQ(faults_with_file(dbc_machine(),
                                   with(kBoardDbc, "Count : 32|4@1+ (1,0) [0|14]",
                                        "Count : 32|3@1+ (1,0) [0|7]"),
                                   machine),
                  "");
        machine.can.stale_after_us = 12'000;
        ASSERT_EQ(machine.can.counter_delta_max, 6);
        AxisEncoder encoder(machine);
        AxisReceiver receiver(machine);
        Heard heard;
        for (std::uint64_t k = 0; k < 20; ++k) {
            const std::vector<CanFrame> frames = frames_of(encoder, snapshot_of(k));
            if (k < 10 || k >= 10 + lost) {
                listen(receiver, frames, heard);
            }
        }
        EXPECT_EQ(receiver.counters().of(ReceiverFault::wrong_sequence), lost == 2 ? 0U : 2U);
    }
}

TEST(SignalReceiver, AFloatThatIsNoNumberStops) {
    for (const std::uint32_t bits : {0x7FC00000U, 0x7F800000U, 0xFF800000U}) {
        Board board(dbc_machine());
        board.send(0);
        board.send(1, [bits](std::vector<CanFrame>& frames) {
            for (unsigned i = 0; i < 4; ++i) {
                frames[1].data[i] = static_cast<std::uint8_t>(bits >> (24 - 8 * i));
            }
        });
        EXPECT_EQ(board.receiver.stop_cause(), ReceiverFault::no_position);
        EXPECT_EQ(board.heard.faults.back().axis, 1U);
    }
}

std::string paged_machine() {
    return with(with(dbc_machine(), "X: Linear.X", "X: Pages.P0"), "A: Tilt.A", "A: Pages.P1");
}

TEST(SignalReceiver, PagesOfOneMessageMakeOneSnapshot) {
    Board board(paged_machine());
    for (std::uint64_t k = 0; k < 20; ++k) {
        board.send(k);
    }
    EXPECT_TRUE(board.heard.faults.empty());
    ASSERT_EQ(board.heard.snapshots.size(), 20U);
    EXPECT_NEAR(board.heard.snapshots[19].position[0], snapshot_of(19).position[0], 0.51e-3);
    EXPECT_NEAR(board.heard.snapshots[19].position[1], snapshot_of(19).position[1], 1e-5);
}

TEST(SignalReceiver, APageThatCarriesNoAxisIsNotOurs) {
    Board board(paged_machine());
    board.send(0);
    board.send(1, [](std::vector<CanFrame>& frames) {
        CanFrame other = frames[0];
        other.data[0] = 7;
        frames.insert(frames.begin(), other);
    });
    EXPECT_EQ(board.receiver.counters().foreign, 1U);
    EXPECT_EQ(board.heard.snapshots.size(), 2U);
    EXPECT_TRUE(board.heard.faults.empty());
}

TEST(SignalReceiver, AFrameOfAnotherLengthIsRefusedWhateverItsPage) {
    Board board(paged_machine());
    board.send(0, [](std::vector<CanFrame>& frames) { frames[0].length_bytes = 7; });
    EXPECT_EQ(board.count(ReceiverFault::bad_length), 1U);
    EXPECT_TRUE(board.heard.snapshots.empty());
}

TEST(SignalFrames, OneCountOfAFloatIsItsStepAtTheEndOfTheTravel) {
    const Machine machine = machine_of(dbc_machine());
    const AxisFrameSet set = make_frame_set(machine);
    const auto end = static_cast<float>(110 * kPi / 180);
    const double step = static_cast<double>(std::nextafter(end, 1e9F)) - static_cast<double>(end);
    EXPECT_NEAR(set.axes[1].unit, step, 1e-12);
}

}  // namespace
}  // namespace axg
