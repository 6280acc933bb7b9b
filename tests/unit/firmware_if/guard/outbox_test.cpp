// SPDX-License-Identifier: Apache-2.0
// One own frame in flight, the stop before everything: by a wire that keeps what it was given.
#include "firmware_if/guard/outbox.hpp"

#include <gtest/gtest.h>

#include "tests/support/test_wire.hpp"

namespace axg {
namespace {

constexpr std::int64_t kLimitUs = 2000;

CanFrame frame(std::uint32_t id, std::uint8_t byte = 0) {
    CanFrame made;
    made.id = id;
    made.length_bytes = 1;
    made.data[0] = byte;
    return made;
}

class OutboxTest : public testing::Test {
  protected:
    /// Brings the echoes that are due, then lets the outbox work.
    OutboxResult at(std::int64_t now_us) {
        wire.now_us = now_us;
        CanArrival arrival;
        while (wire.read(arrival) == ReadStatus::frame) {
            outbox.on_echo(arrival.frame);
        }
        return outbox.work(now_us);
    }
    std::vector<std::uint32_t> ids() const {
        std::vector<std::uint32_t> all;
        for (const CanFrame& sent : wire.sent) {
            all.push_back(sent.id);
        }
        return all;
    }

    test::TestWire wire;
    Outbox outbox{wire, kLimitUs};
};

TEST_F(OutboxTest, TheTwinFollowsThePlainFrameWhenThatWasSeen) {
    outbox.put_heartbeat(frame(0x702));
    outbox.put_permit({frame(0x103), frame(0x104)});
    EXPECT_FALSE(at(0).has_failed);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103}));
    outbox.put_emergency(frame(0x082));
    EXPECT_FALSE(at(149).was_heard);
    EXPECT_EQ(wire.sent.size(), 1U);
    EXPECT_TRUE(at(150).was_heard);
    (void)at(300);
    (void)at(450);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103, 0x104, 0x082, 0x702}));
}

// A heartbeat loses against every axis frame on the bus: a permit that waited for its echo would
// come after the next sample.
TEST_F(OutboxTest, APermitWaitsForNoHeartbeatAndAHeartbeatForEveryPermit) {
    wire.echo_us = 1000;
    outbox.put_heartbeat(frame(0x702));
    (void)at(0);
    outbox.put_emergency(frame(0x082));
    outbox.put_permit({frame(0x103), frame(0x104)});
    wire.echo_us = 150;
    (void)at(10);
    (void)at(160);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x702, 0x103, 0x104}));
    EXPECT_FALSE(at(999).has_failed);
    EXPECT_EQ(wire.sent.size(), 3U) << "one of the last three at a time";
    EXPECT_TRUE(at(1000).was_heard);
    EXPECT_EQ(ids().back(), 0x082U);
}

TEST_F(OutboxTest, AHeartbeatThatIsNotSeenFailsThoughPermitsAre) {
    outbox.put_heartbeat(frame(0x702));
    wire.is_deaf = true;
    (void)at(0);
    wire.is_deaf = false;
    for (std::int64_t now_us = 100; now_us <= kLimitUs; now_us += 100) {
        outbox.put_permit({frame(0x103, static_cast<std::uint8_t>(now_us / 100)), frame(0x104)});
        EXPECT_FALSE(at(now_us).has_failed) << now_us;
    }
    EXPECT_TRUE(at(kLimitUs + 1).has_failed);
}

TEST_F(OutboxTest, ANewerPermitTakesThePlaceOfOneThatHasNotLeft) {
    outbox.put_heartbeat(frame(0x702));
    (void)at(0);
    outbox.put_permit({frame(0x103, 1), frame(0x104, 1)});
    outbox.put_permit({frame(0x103, 2), frame(0x104, 2)});
    (void)at(150);
    outbox.put_permit({frame(0x103, 3), frame(0x104, 3)});  // its twin is owed: too late
    (void)at(300);
    (void)at(450);
    ASSERT_EQ(ids(), (std::vector<std::uint32_t>{0x702, 0x103, 0x104}));
    EXPECT_EQ(wire.sent[1].data[0], 2);
    EXPECT_EQ(wire.sent[2].data[0], 2);
}

TEST_F(OutboxTest, QuickStopsFollowTheStopAndWaitForNoEcho) {
    outbox.put_permit({frame(0x103), frame(0x104)});
    (void)at(0);
    for (int period = 0; period < 2; ++period) {
        outbox.put_stop(frame(0x001));
        outbox.put_quick_stop(frame(0x303));
        outbox.put_quick_stop(frame(0x304));
        outbox.put_emergency(frame(0x082));
        (void)at(1 + 1000 * period);
    }
    (void)at(1200);
    EXPECT_EQ(ids(),
              (std::vector<std::uint32_t>{0x103, 0x001, 0x303, 0x304, 0x001, 0x303, 0x304, 0x082}))
        << "the emergency waited for the stop's echo, the second stop for nothing";
}

TEST_F(OutboxTest, AQuickStopIsTriedAgainInAFullQueueAndWithdrawnByANewerStop) {
    outbox.put_stop(frame(0x001));
    outbox.put_quick_stop(frame(0x303, 1));
    outbox.put_quick_stop(frame(0x304, 1));
    wire.reply = SendStatus::busy;
    (void)at(0);
    (void)at(100);
    EXPECT_TRUE(ids().empty());
    EXPECT_EQ(outbox.next_due_us(), 200);
    wire.reply = SendStatus::ok;
    (void)at(200);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x001, 0x303, 0x304}));
    wire.reply = SendStatus::busy;
    outbox.put_stop(frame(0x001));
    outbox.put_quick_stop(frame(0x303, 2));
    (void)at(1000);
    outbox.put_stop(frame(0x001));
    outbox.put_quick_stop(frame(0x305, 3));
    wire.reply = SendStatus::ok;
    (void)at(1100);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x001, 0x303, 0x304, 0x001, 0x305}));
}

// The permit's echo never came when the stop is put: neither it nor the quick stops are forgotten.
TEST_F(OutboxTest, AFrameThatWasNotSeenTakesNoStopAway) {
    wire.is_deaf = true;
    outbox.put_permit({frame(0x103), frame(0x104)});
    (void)at(0);
    outbox.put_stop(frame(0x001));
    outbox.put_quick_stop(frame(0x303));
    EXPECT_TRUE(at(kLimitUs + 1).has_failed);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103, 0x001, 0x303}));
}

TEST_F(OutboxTest, MoreQuickStopsThanAxesAreNotSent) {
    outbox.put_stop(frame(0x001));
    for (std::uint32_t i = 0; i < kAxesMax + 3; ++i) {
        outbox.put_quick_stop(frame(0x300 + i));
    }
    (void)at(0);
    EXPECT_EQ(wire.sent.size(), 1 + kAxesMax);
}

TEST_F(OutboxTest, TheStopWaitsForNoEchoAndTakesThePermitAway) {
    outbox.put_permit({frame(0x103), frame(0x104)});
    outbox.put_heartbeat(frame(0x702));
    (void)at(0);
    outbox.put_stop(frame(0x001));
    (void)at(1);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103, 0x001}));
    for (std::int64_t now = 50; now < 2000; now += 50) {
        EXPECT_FALSE(at(now).has_failed);
    }
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103, 0x001, 0x702}));
}

TEST_F(OutboxTest, APermitThatHasNotLeftWhenTheStopComesNeverLeaves) {
    outbox.put_heartbeat(frame(0x702));
    (void)at(0);
    outbox.put_permit({frame(0x103), frame(0x104)});
    outbox.put_stop(frame(0x001));
    for (std::int64_t now = 50; now < 2000; now += 50) {
        (void)at(now);
    }
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x702, 0x001}));
    EXPECT_EQ(outbox.next_due_us(), INT64_MAX);
}

TEST_F(OutboxTest, AFrameThatIsNotSeenFailsOnBothSidesOfTheLimit) {
    wire.is_deaf = true;
    outbox.put_heartbeat(frame(0x702));
    EXPECT_FALSE(at(0).has_failed);
    EXPECT_EQ(outbox.next_due_us(), kLimitUs + 1);
    EXPECT_FALSE(at(kLimitUs).has_failed);
    const OutboxResult late = at(kLimitUs + 1);
    EXPECT_TRUE(late.has_failed);
    EXPECT_EQ(late.status, SendStatus::ok) << "the kernel took it";
    EXPECT_FALSE(at(kLimitUs + 2).has_failed) << "said once";
}

TEST_F(OutboxTest, AFullQueueIsTriedAgainUntilTheLimit) {
    wire.reply = SendStatus::busy;
    outbox.put_permit({frame(0x103), frame(0x104)});
    std::int64_t now_us = 1;
    while (now_us < 1 + kLimitUs) {
        EXPECT_FALSE(at(now_us).has_failed) << now_us;
        EXPECT_EQ(outbox.next_due_us(), now_us + kSendRetryUs);
        now_us += kSendRetryUs;
        outbox.put_permit({frame(0x103), frame(0x104)});  // a newer one gains no time
    }
    EXPECT_FALSE(at(now_us).has_failed);
    EXPECT_TRUE(at(now_us + kSendRetryUs).has_failed);
    EXPECT_EQ(wire.applied, 22U);
    wire.reply = SendStatus::ok;
    outbox.put_stop(frame(0x001));
    (void)at(now_us + 2 * kSendRetryUs);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x001})) << "nothing old is kept";
}

TEST_F(OutboxTest, WhatCannotGetBetterFailsAtOnce) {
    for (const SendStatus status : {SendStatus::down, SendStatus::gone, SendStatus::failed}) {
        wire.reply = status;
        outbox.put_heartbeat(frame(0x702));
        const OutboxResult result = at(10);
        EXPECT_TRUE(result.has_failed);
        EXPECT_EQ(result.status, status);
    }
}

// The word lets a board stop that does not obey the stop frame: it waits for no echo, and stops
// sent again do not cut it off.
TEST_F(OutboxTest, TheStopWordFollowsItsStopAtOnceAndIsNotWithdrawnByTheNext) {
    outbox.put_permit({frame(0x103), frame(0x104)});
    (void)at(0);
    outbox.put_stop(frame(0x001));
    outbox.put_quick_stop(frame(0x303));
    outbox.put_stop_word({frame(0x103, 1), frame(0x104, 1)});
    outbox.put_emergency(frame(0x082));
    outbox.send_stop(10);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103, 0x001, 0x303, 0x103, 0x104}))
        << "the twin of before was withdrawn";
    EXPECT_EQ(wire.sent[3].data[0], 1);
    EXPECT_EQ(wire.sent[4].data[0], 1);
    EXPECT_FALSE(at(160).has_failed);
    EXPECT_EQ(ids().back(), 0x082U) << "what is no stop waits for its echo";
    wire.sent.clear();
    wire.reply = SendStatus::busy;
    outbox.put_stop(frame(0x001));
    outbox.put_stop_word({frame(0x103, 3), frame(0x104, 3)});
    outbox.send_stop(600);
    outbox.put_stop(frame(0x001));
    wire.reply = SendStatus::ok;
    outbox.send_stop(650);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x001, 0x103, 0x104}));
    (void)at(800);
    wire.sent.clear();
    // A permit of later is withdrawn by a stop, as ever.
    outbox.put_permit({frame(0x103, 2), frame(0x104, 2)});
    outbox.put_stop(frame(0x001));
    (void)at(1050);
    (void)at(1200);
    (void)at(1350);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x001}));
}

// The queue was full for a permit a moment ago: that says nothing about the stop.
TEST_F(OutboxTest, AStopIsTriedAtOnceAndWhatCameOfItIsToldWithTheRest) {
    wire.reply = SendStatus::busy;
    outbox.put_permit({frame(0x103), frame(0x104)});
    (void)at(0);
    wire.reply = SendStatus::ok;
    outbox.put_stop(frame(0x001));
    outbox.send_stop(1);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x001}));
    EXPECT_TRUE(at(151).was_heard);
    wire.reply = SendStatus::down;
    outbox.put_stop(frame(0x001));
    outbox.send_stop(1000);
    wire.reply = SendStatus::ok;
    const OutboxResult result = at(1001);
    EXPECT_TRUE(result.has_failed);
    EXPECT_EQ(result.status, SendStatus::down);
    EXPECT_FALSE(at(1002).has_failed) << "said once";
}

TEST_F(OutboxTest, HintsLeaveLast) {
    outbox.put_hints(frame(0x682));
    outbox.put_status(frame(0x604));
    outbox.put_hash(frame(0x602));
    outbox.put_heartbeat(frame(0x702));
    outbox.put_emergency(frame(0x082));
    outbox.put_permit({frame(0x103), frame(0x104)});
    for (std::int64_t now_us = 0; now_us <= 1050; now_us += 150) {
        (void)at(now_us);
    }
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x103, 0x104, 0x082, 0x702, 0x602, 0x604, 0x682}));
}

TEST_F(OutboxTest, NoPermitAndNoStopWaitsForAStatusInFlight) {
    outbox.put_status(frame(0x604));
    (void)at(0);
    wire.is_deaf = true;  // its echo comes at 150, theirs do not matter here
    outbox.put_permit({frame(0x103), frame(0x104)});
    (void)at(10);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x604, 0x103}));
    outbox.put_stop(frame(0x001));
    (void)at(20);
    EXPECT_EQ(ids(), (std::vector<std::uint32_t>{0x604, 0x103, 0x001}));
    outbox.put_status(frame(0x604, 1));
    outbox.put_heartbeat(frame(0x702));
    (void)at(30);
    EXPECT_EQ(wire.sent.size(), 3U) << "and a status waits for the stop";
}

}  // namespace
}  // namespace axg
