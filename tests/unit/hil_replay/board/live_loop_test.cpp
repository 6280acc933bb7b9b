// SPDX-License-Identifier: Apache-2.0
// The board on a wire in real time, by a clock that only its waits advance: when frames leave, what
// is heard and from when it counts.
#include "hil_replay/board/live_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/guard/monitor.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/motion_machine.hpp"

namespace axg::test {
namespace {

constexpr std::array<double, 5> kStart{};
constexpr ConfigurationHashes kHashes{{11, 22, 33, 44}};

Approach to_the_right() {
    Approach approach;
    approach.target = {100, 0, -50, -0.5, 1};
    approach.speed_share.fill(1);
    return approach;
}

class LiveLoopTest : public testing::Test {
  protected:
    void cycles(int count) {
        for (int i = 0; i < count; ++i) {
            ASSERT_TRUE(loop.cycle());
        }
    }
    std::size_t sent_of(std::uint32_t id) const {
        return static_cast<std::size_t>(
            std::count_if(bus.wire.sent.begin(), bus.wire.sent.end(),
                          [id](const CanFrame& frame) { return frame.id == id; }));
    }

    Machine machine = [] {
        Machine out = motion_test_machine();
        out.can.hashes_in_id = 0x582;
        out.can.hashes_out_id = 0x602;
        return out;
    }();
    LiveBus bus{machine, 600, kHashes};
    MotionBoard board{machine, kStart, make_approach(machine, to_the_right()), {.hashes = kHashes}};
    LiveLoop loop{machine, board, bus.wire, bus.clock()};
};

// One SYNC and all axis frames a period, at the instant of the latch and no other.
TEST_F(LiveLoopTest, EachPeriodLeavesAtItsLatch) {
    const std::int64_t begun_us = bus.now_us();
    ASSERT_TRUE(loop.listen());
    EXPECT_TRUE(bus.wire.sent.empty()) << "it listens first";
    for (int i = 0; i < 50; ++i) {
        // Shortly before the next latch: a frame that ends the sleep too soon.
        bus.wire.arrive(encode_emergency(machine.can, {}, bus.now_us() + 900));
        cycles(1);
    }
    EXPECT_EQ(sent_of(machine.can.sync_id), 50U);
    EXPECT_EQ(sent_of(machine.can.axis_ids.back()), 50U);
    for (const CanFrame& frame : bus.wire.sent) {
        EXPECT_EQ((frame.time_us - begun_us - LiveLoop::kListenUs) % machine.can.sample_us, 0);
    }
    EXPECT_EQ(loop.report().late_periods, 0U);
    EXPECT_EQ(board.state(), BoardState::moving);
}

// Late is more than half a period; how late the worst was is kept.
TEST_F(LiveLoopTest, LatePeriodsAreCounted) {
    ASSERT_TRUE(loop.listen());
    bus.has_guard = false;
    cycles(3);
    for (const std::int64_t late_us : {500, 501, 800, 20}) {
        bus.oversleep_us = late_us;
        cycles(3);
    }
    EXPECT_EQ(loop.report().late_periods, 2U);
    EXPECT_EQ(loop.report().late_us_max, 800);
    EXPECT_EQ(sent_of(machine.can.sync_id), 15U) << "what is late is sent all the same";
}

// A stop counts from its arrival, not from when a sleeping board reads it.
TEST_F(LiveLoopTest, AStopCountsFromItsArrival) {
    ASSERT_TRUE(loop.listen());
    cycles(30);
    ASSERT_EQ(board.state(), BoardState::moving);
    const std::int64_t at_us = board.next_latch_us() - 700 + 1000;
    const std::int64_t later_us = bus.now_us() - loop.board_now_us();
    bus.wire.arrive(encode_stop(machine.can, at_us + later_us));
    bus.is_deaf_asleep = true;
    cycles(200);
    EXPECT_EQ(board.state(), BoardState::stopped);
    EXPECT_EQ(board.stop().why, BoardStop::guard_said_stop);
    EXPECT_EQ(board.stop().asked_us, at_us);
}

// Without a guard the permit runs out n periods after its sample, and the board brakes by itself.
TEST_F(LiveLoopTest, ABoardWhoseGuardDiesBrakes) {
    ASSERT_TRUE(loop.listen());
    cycles(30);
    bus.has_guard = false;
    cycles(200);
    EXPECT_EQ(board.state(), BoardState::stopped);
    EXPECT_EQ(board.stop().why, BoardStop::permit_ran_out);
    EXPECT_EQ(board.stop().asked_us - board.stop().certified_us,
              machine.can.permit_samples.most * machine.can.sample_us);
}

TEST_F(LiveLoopTest, APersonsStopBrakes) {
    ASSERT_TRUE(loop.listen());
    cycles(30);
    const std::int64_t at_us = loop.board_now_us();
    board.stop_by_person(at_us);
    cycles(200);
    EXPECT_EQ(board.state(), BoardState::stopped);
    EXPECT_EQ(board.stop().why, BoardStop::person_said_stop);
    EXPECT_EQ(board.stop().asked_us, at_us);
}

// A guard that was stopped before repeats its stop until a board says that it stands: that board
// may move when the guard was reset, but with no permit from before.
TEST_F(LiveLoopTest, AStopBeforeTheFirstPermitIsAcknowledged) {
    ASSERT_TRUE(loop.listen());
    bus.has_guard = false;
    cycles(2);
    Permit permit{PermitWord::run, 2, 1, kKnownAnswerSignature, 0, 255, 0};
    for (const CanFrame& frame : encode_permit(machine.can, permit, bus.now_us() + 100)) {
        bus.wire.arrive(frame);
    }
    bus.wire.arrive(encode_stop(machine.can, bus.now_us() + 200));
    cycles(5);
    EXPECT_EQ(board.state(), BoardState::waiting) << "the permit was of before the stop";
    bus.has_guard = true;
    cycles(130);  // until the next session frame
    EXPECT_EQ(board.state(), BoardState::moving);
}

TEST_F(LiveLoopTest, WhatTheWireHeldBeforeIsForgotten) {
    for (int i = 0; i < 2; ++i) {
        bus.wire.arrive(encode_stop(machine.can, bus.wire.now_us));
    }
    const LiveLoop next(machine, board, bus.wire, bus.clock());
    EXPECT_FALSE(bus.wire.has_arrivals());
}

// The id of each frame that a board alone sends; echoes of its own are none of another's.
TEST_F(LiveLoopTest, AnotherBoardOnTheWireIsNoticed) {
    const std::vector<std::uint32_t> ids{machine.can.sync_id,      machine.can.axis_ids[0],
                                         machine.can.axis_ids[2],  machine.can.heartbeat_in_id,
                                         machine.can.hashes_in_id, machine.can.session_in_id};
    for (const std::uint32_t id : ids) {
        LiveBus other(machine, 600);
        LiveLoop listener(machine, board, other.wire, other.clock());
        CanFrame frame;
        frame.id = id;
        frame.time_us = other.now_us() + 1000;
        other.wire.arrive(frame);
        EXPECT_FALSE(listener.listen()) << id;
        EXPECT_EQ(listener.report().other_board_id, id);
        EXPECT_TRUE(other.wire.sent.empty());
    }
    ASSERT_TRUE(loop.listen());
    cycles(20);
    EXPECT_EQ(loop.report().other_board_id, 0U);
}

// The guard asks with its own hash of a part; the board's own goes back.
TEST_F(LiveLoopTest, HashesAreAnswered) {
    ASSERT_TRUE(loop.listen());
    bus.has_guard = false;
    bus.wire.arrive(encode_hash(machine.can.hashes_out_id, {2, 99}, bus.now_us() + 100));
    cycles(2);
    ASSERT_EQ(sent_of(machine.can.hashes_in_id), 1U);
    const auto answer = std::find_if(
        bus.wire.sent.begin(), bus.wire.sent.end(),
        [this](const CanFrame& frame) { return frame.id == machine.can.hashes_in_id; });
    HashFrame hash;
    ASSERT_TRUE(decode_hash(*answer, hash));
    EXPECT_EQ(hash.part, 2);
    EXPECT_EQ(hash.hash, 33U);
}

// Each of the guard's is answered; a part that differs, or that the guard never said, keeps a board
// where it is.
TEST_F(LiveLoopTest, ABoardOfAnotherMachineDoesNotMove) {
    for (std::size_t part = 0; part < kHashParts; ++part) {
        ConfigurationHashes others = kHashes;
        others.of[part] += 1;
        LiveBus other(machine, 600, others);
        MotionBoard waits(machine, kStart, make_approach(machine, to_the_right()),
                          {.hashes = kHashes});
        LiveLoop waiting(machine, waits, other.wire, other.clock());
        ASSERT_TRUE(waiting.listen());
        for (int i = 0; i < 100; ++i) {
            ASSERT_TRUE(waiting.cycle());
        }
        EXPECT_EQ(waits.state(), BoardState::waiting) << part;
        EXPECT_EQ(std::count_if(other.wire.sent.begin(), other.wire.sent.end(),
                                [this](const CanFrame& frame) {
                                    return frame.id == machine.can.hashes_in_id;
                                }),
                  4);
    }
}

TEST_F(LiveLoopTest, AHashThatChangesInMotionStops) {
    ASSERT_TRUE(loop.listen());
    cycles(30);
    ASSERT_EQ(board.state(), BoardState::moving);
    bus.wire.arrive(encode_hash(machine.can.hashes_out_id, {2, 99}, bus.now_us() + 100));
    cycles(200);
    EXPECT_EQ(board.state(), BoardState::stopped);
    EXPECT_EQ(board.stop().why, BoardStop::guard_said_stop);
}

TEST_F(LiveLoopTest, TheLastEmergencyOfAStopIsKept) {
    ASSERT_TRUE(loop.listen());
    bus.has_guard = false;
    const Emergency sent{.code = EmergencyCode::predicted_collision, .error_register = 1};
    bus.wire.arrive(encode_emergency(machine.can, sent, bus.now_us() + 100));
    bus.wire.arrive(encode_emergency(machine.can, {}, bus.now_us() + 200));
    cycles(2);
    ASSERT_TRUE(loop.report().emergency.has_value());
    EXPECT_EQ(loop.report().emergency->code, EmergencyCode::predicted_collision);
}

// A queue that is full refuses frames; an interface that is down is lost as well, whichever of
// sending and reading notices.
TEST_F(LiveLoopTest, RefusedFramesAndALostInterfaceAreReported) {
    ASSERT_TRUE(loop.listen());
    bus.has_guard = false;
    cycles(1);
    const std::size_t frames = bus.wire.sent.size();
    bus.wire.reply = SendStatus::busy;
    cycles(1);
    EXPECT_GT(frames, 3U);
    EXPECT_GE(loop.report().frames_refused, frames - 2) << "but heartbeat and session";
    EXPECT_FALSE(loop.report().is_lost);
    bus.wire.reply = SendStatus::down;
    cycles(1);
    EXPECT_TRUE(loop.report().is_lost);
    for (const ReadStatus status : {ReadStatus::down, ReadStatus::gone}) {
        LiveBus other(machine, 600);
        LiveLoop reader(machine, board, other.wire, other.clock());
        other.wire.inject(status);
        EXPECT_TRUE(reader.listen());
        EXPECT_TRUE(reader.report().is_lost);
    }
}

}  // namespace
}  // namespace axg::test
