// SPDX-License-Identifier: Apache-2.0
// The receiver between a board's samples and its session frames: which lap a sample has, for how
// long that is known, and what is found by a session frame that does not agree.
#include <gtest/gtest.h>

#include "tests/support/receiver_fixture.hpp"
#include "tests/support/session_frame.hpp"

namespace axg {
namespace {

using test::session_frame;
using test::SessionSays;

/// A board that has run for `first` samples when the receiver begins to listen.
class SessionBoard {
  public:
    explicit SessionBoard(CanFormat format, std::uint64_t first = 0)
        : machine(machine_of(format)),
          receiver(machine),
          encoder_(machine, {.says_session = false}),
          number_(first) {}

    /// The next sample; what the receiver said of it.
    ReceiverEvent sample() {
        ReceiverEvent last;
        for (const CanFrame& frame : test::frames_of(encoder_, snapshot_at(number_))) {
            const ReceiverEvent event = receiver.on_frame(frame);
            last = event.kind == ReceiverEvent::Kind::none ? last : event;
        }
        ++number_;
        return last;
    }
    void run(std::uint64_t count) {
        for (std::uint64_t i = 0; i < count; ++i) {
            (void)sample();
        }
    }
    [[nodiscard]] SessionSays says() {
        return {.number = number_ - 1, .counter = static_cast<std::uint8_t>(++counter_ % 16)};
    }
    /// A session frame, heard with the last sample.
    ReceiverEvent say(const SessionSays& says) {
        return receiver.on_frame(session_frame(says, now_us()));
    }
    ReceiverEvent say() { return say(says()); }
    [[nodiscard]] std::int64_t now_us() const {
        return test::snapshot_at(machine, number_).latched_us - 1;
    }
    [[nodiscard]] std::uint64_t newest() const { return number_ - 1; }

    Machine machine;
    AxisReceiver receiver;

  private:
    static Machine machine_of(CanFormat format) {
        Machine machine = test::five_axis_machine(format);
        return machine;
    }
    [[nodiscard]] AxisSnapshot snapshot_at(std::uint64_t number) const {
        AxisSnapshot snapshot = test::snapshot_at(machine, number);
        snapshot.sample = number;
        return snapshot;
    }

    AxisEncoder encoder_;
    std::uint64_t number_;
    std::uint8_t counter_ = 0;
};

class SessionAssembly : public testing::TestWithParam<CanFormat> {};

TEST_P(SessionAssembly, EachSampleHasTheLapThatTheBoardGaveIt) {
    for (const std::uint64_t first : {0U, 100U, 239U, 245U}) {
        SessionBoard board(GetParam(), first);
        EXPECT_FALSE(board.receiver.session_of(1)) << "no session yet";
        board.run(5);
        EXPECT_EQ(board.say().kind, ReceiverEvent::Kind::none);
        for (std::uint64_t i = 0; i < 700; ++i) {
            ASSERT_EQ(board.sample().kind, ReceiverEvent::Kind::snapshot);
            for (const std::uint64_t before : {0U, 4U, 15U}) {
                if (board.newest() < before) {
                    continue;
                }
                const std::uint64_t number = board.newest() - before;
                const auto session = board.receiver.session_of(sync_counter_of(number));
                ASSERT_TRUE(session);
                EXPECT_EQ(session->nonce, 0xC0FFEEU);
                EXPECT_EQ(session->lap, number / 240) << first << ' ' << i;
            }
            if (i % 100 == 0) {
                ASSERT_EQ(board.say().kind, ReceiverEvent::Kind::none) << i;
            }
        }
    }
}

TEST_P(SessionAssembly, ItIsKnownFor300MsAndNotAMicrosecondLonger) {
    SessionBoard board(GetParam());
    board.run(5);
    (void)board.say();
    const std::int64_t said_us = board.now_us();
    const std::uint8_t sync = sync_counter_of(board.newest());
    (void)board.receiver.on_time(said_us + kSessionTimeoutUs);
    // The axes are stale by then, and say so; the session has a time of its own.
    EXPECT_TRUE(board.receiver.session_of(sync));
    (void)board.receiver.on_time(said_us + kSessionTimeoutUs + 1);
    EXPECT_FALSE(board.receiver.session_of(sync));
}

TEST_P(SessionAssembly, AnotherLapIsAStop) {
    SessionBoard board(GetParam());
    board.run(300);
    (void)board.say();
    board.run(300);
    SessionSays says = board.says();
    says.number += 240;
    const ReceiverEvent event = board.say(says);
    EXPECT_EQ(event.fault, ReceiverFault::held_up);
    EXPECT_EQ(event.severity, Severity::stop);
    EXPECT_EQ(event.frame_id, 0x583U);
    EXPECT_EQ(board.receiver.state(), ReceiverState::invalid);
}

TEST_P(SessionAssembly, AnotherNonceBeginsAnew) {
    SessionBoard board(GetParam());
    board.run(5);
    (void)board.say();
    SessionSays armed = board.says();
    armed.nonce = 7;
    armed.number += 240 * 9;
    EXPECT_EQ(board.say(armed).kind, ReceiverEvent::Kind::none);
    EXPECT_EQ(board.receiver.session_of(sync_counter_of(board.newest())),
              (SampleSession{.nonce = 7, .lap = 9}));
}

TEST_P(SessionAssembly, ASpoiledSecondOrRepeatedFrameIsNotUsed) {
    SessionBoard board(GetParam());
    board.run(5);
    const SessionSays says = board.says();
    CanFrame bad = session_frame(says, board.now_us());
    bad.data[6] ^= 1U;
    EXPECT_EQ(board.receiver.on_frame(bad).fault, ReceiverFault::bad_crc);
    EXPECT_FALSE(board.receiver.session_of(1));
    (void)board.say(says);
    EXPECT_EQ(board.say(says).fault, ReceiverFault::repeated);
    SessionSays other = says;
    other.nonce = 8;
    EXPECT_EQ(board.say(other).fault, ReceiverFault::spoofed) << "a second board";
}

// What was counted before an acknowledge says nothing of the samples after it.
TEST_P(SessionAssembly, AnAcknowledgeForgetsTheSession) {
    SessionBoard board(GetParam());
    board.run(5);
    (void)board.say();
    board.receiver.acknowledge();
    board.run(3);
    EXPECT_FALSE(board.receiver.session_of(sync_counter_of(board.newest())));
    (void)board.say();
    EXPECT_TRUE(board.receiver.session_of(sync_counter_of(board.newest())));
}

TEST_P(SessionAssembly, BeforeTheFirstSampleASessionSaysNothing) {
    SessionBoard board(GetParam());
    (void)board.receiver.on_frame(session_frame({.number = 3}, 999'000));
    board.run(3);
    EXPECT_FALSE(board.receiver.session_of(1));
}

INSTANTIATE_TEST_SUITE_P(Native, SessionAssembly,
                         testing::Values(CanFormat::classical, CanFormat::fd));

// Without a sample counter the id may be anybody's.
TEST(SessionAssemblySignals, ReadNoSession) {
    AxisReceiver receiver(test::five_axis_machine(CanFormat::signals));
    (void)receiver.on_frame(session_frame({.number = 3}, 999'000));
    EXPECT_EQ(receiver.counters().foreign, 1U);
}

// The ack of a sample is kept; in a jog the same bits are its axis.
TEST(SessionAssemblyFlags, TheAckIsReadOutsideOfAJog) {
    AxisSnapshot snapshot;
    EXPECT_FALSE(acked_permit(snapshot));
    snapshot.flags = 0x34;
    EXPECT_EQ(acked_permit(snapshot), 3);
    snapshot.flags = 0x30;
    EXPECT_FALSE(acked_permit(snapshot)) << "bit 2 says whether there is one";
    snapshot.flags = 0x34;
    snapshot.mode = kModeJog;
    EXPECT_FALSE(acked_permit(snapshot));
}

}  // namespace
}  // namespace axg
