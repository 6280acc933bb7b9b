// SPDX-License-Identifier: Apache-2.0
// A stop of the board's own ends the permits without a stop of the guard, until all axes rest and a
// person has armed the board and the guard anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "firmware_if/guard/guard_chain.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

class OwnStop : public testing::Test {
  protected:
    OwnStop() {
        set_latch(latch, false);
        world.says_session = [this](SessionSays& says) {
            says.nonce = nonce;
            return true;
        };
        world.verdict = [this](std::uint64_t) {
            CycleResult result;
            result.reason = reason;
            result.has_permit = reason == StopReason::none;
            result.is_stop = reason == StopReason::left_limits;
            result.known_answer_signature = kKnownAnswerSignature;
            return result;
        };
        world.start();
        world.run_to_armed();
        world.run_periods(20);
    }
    [[nodiscard]] const Guard& guard() const { return world.guard->guard(); }
    std::size_t permits_in(std::int64_t periods) {
        const std::int64_t from_us = world.wire.now_us;
        world.run_periods(periods);
        return world.count_sent(0x103, from_us);
    }
    void stop_of_the_board(std::int64_t periods) {
        reason = StopReason::own_stop;
        world.run_periods(2);
        EXPECT_EQ(permits_in(periods), 0U);
        reason = StopReason::none;
    }

    std::string refusal() {
        std::string words;
        LiveNote note;
        while (world.queues->notes.pop(note)) {
            words = note.kind == LiveNote::Kind::refused ? note.words : words;
        }
        return words;
    }

    static Machine machine() {
        Machine machine = five_axis_machine(CanFormat::classical);
        return machine;
    }
    LatchCell latch;
    LiveWorld world{machine(), latch};
    std::uint32_t nonce = 0xC0FFEE;
    StopReason reason = StopReason::none;
};

TEST_F(OwnStop, EndsThePermitsAndIsNoStopOfTheGuard) {
    ASSERT_EQ(guard().phase, GuardPhase::armed);
    EXPECT_GT(permits_in(20), 10U);
    stop_of_the_board(200);
    EXPECT_EQ(guard().phase, GuardPhase::selftest);
    EXPECT_EQ(world.guard->withheld().why, WithheldPermit::Why::not_proven);
    EXPECT_EQ(world.guard->withheld().reason, StopReason::own_stop);
    EXPECT_EQ(world.count_sent(world.machine.can.stop_id), 0U);
    EXPECT_TRUE(is_latched(latch)) << "a process that dies now comes back stopped";
}

TEST_F(OwnStop, APersonArmsTheBoardAndThenTheGuard) {
    world.stands_still = true;
    stop_of_the_board(20);
    world.run_periods(200);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    world.guard->arm(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_NE(refusal().find("arm the board first"), std::string::npos);
    nonce = 0xC0FFEF;
    EXPECT_EQ(permits_in(200), 0U) << "nobody armed the guard";
    world.guard->arm(world.wire.now_us);
    EXPECT_GT(permits_in(20), 10U);
}

// A session that is not heard is no new one.
TEST_F(OwnStop, WithoutASessionNobodyArms) {
    world.stands_still = true;
    stop_of_the_board(20);
    world.run_periods(200);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    world.says_session = [](SessionSays&) { return false; };
    for (int i = 0; i < 500; ++i) {  // at first still ready, with a sample that has no session
        world.run_periods(1);
        EXPECT_FALSE(world.guard->may_arm(world.wire.now_us)) << i;
    }
    world.guard->arm(world.wire.now_us);
    EXPECT_NE(guard().phase, GuardPhase::armed);
}

// Even where arming is only supposed, as of a recording: the axes have to stand.
TEST_F(OwnStop, NobodyArmsInMotion) {
    stop_of_the_board(20);
    nonce = 0xC0FFEF;
    world.run_periods(200);
    EXPECT_FALSE(world.guard->may_arm(world.wire.now_us));
    world.stands_still = true;
    world.run_periods(200);
    EXPECT_TRUE(world.guard->may_arm(world.wire.now_us));
}

// A reset ends the stop of the guard; the board is still the one that nobody armed.
TEST_F(OwnStop, ARestThatDoesNotComeIsAStop) {
    stop_of_the_board(50);
    reason = StopReason::left_limits;
    world.run_periods(5);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::verdict);
    EXPECT_GT(world.count_sent(world.machine.can.stop_id), 0U);
    reason = StopReason::none;
    world.stands_still = true;
    world.run_periods(300);
    world.guard->reset(world.wire.now_us);
    world.run_periods(300);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_FALSE(world.guard->may_arm(world.wire.now_us));
    nonce = 0xC0FFEF;
    world.run_periods(200);
    EXPECT_TRUE(world.guard->may_arm(world.wire.now_us));
}

// Before arming a board that stops keeps the guard from being ready, and owes no new nonce.
TEST_F(OwnStop, BeforeArmingItWaitsForRestAlone) {
    set_latch(latch, false);
    world.start();
    world.run_periods(200);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    reason = StopReason::own_stop;
    world.run_periods(3);
    EXPECT_EQ(guard().phase, GuardPhase::selftest);
    reason = StopReason::none;
    world.run_periods(40);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
}

/// The chain over a table and a head: X moves, then its count rests; Y goes on.
class OwnStopChain : public testing::Test {
  protected:
    static Machine with_one_tool() {
        Machine machine = table_and_head_machine();
        machine.tools.resize(1);
        return machine;
    }
    CycleResult cycle(std::uint64_t sample, bool is_armed) {
        ReceiverEvent event;
        event.kind = ReceiverEvent::Kind::snapshot;
        event.state = sample == 1 ? ReceiverState::init : ReceiverState::valid;
        event.snapshot.sample = sample;
        event.snapshot.axis_count = 5;
        event.snapshot.tool = 1;
        event.snapshot.mode = mode;
        const double t = static_cast<double>(sample) * 1e-3;
        event.snapshot.position[0] = 100 * std::min(t, kFreezesS);
        event.snapshot.position[1] = 50 * t;
        chain.take(event);
        chain.evaluate();
        return chain.decide(true, is_armed);
    }
    /// The receiver begins anew.
    void forget() { static_cast<void>(cycle(1, false)); }
    static constexpr double kFreezesS = 0.04;

    std::uint8_t mode = kModeStandstill;
    Machine m = with_one_tool();
    ContainmentScene scene = table_and_head_scene();
    StopCertificate certificate = certificate_over(scene, m);
    GuardChain chain{m, scene.engine().engine(), scene.containment_test(), {&certificate}};
};

// Begun under permits it owes rest; the guard, armed no more, stops what does not come to rest,
// whatever the board says of its mode.
TEST_F(OwnStopChain, OwesRestThatBeganUnderPermits) {
    for (const bool is_armed : {true, false}) {
        std::uint64_t began = 0, left = 0;
        bool has_stop = false;
        for (std::uint64_t k = 1; k < 700 && !has_stop; ++k) {
            const CycleResult result = cycle(k, is_armed && k > 30 && began == 0);
            if (result.reason == StopReason::own_stop) {
                began = began == 0 ? k : began;
                EXPECT_FALSE(result.has_permit);
                EXPECT_FALSE(result.is_stop);
                EXPECT_EQ(result.limit.kind, LimitKind::frozen_axis);
            }
            left = left == 0 && result.reason == StopReason::left_limits ? k : left;
            has_stop = result.is_stop;
        }
        EXPECT_EQ(began, 41U);
        EXPECT_GT(left, began);
        EXPECT_EQ(has_stop, is_armed);
        forget();
    }
}

TEST_F(OwnStopChain, AGuardThatOnlyReportsGoesOn) {
    m.guard.reports_limits = true;
    for (std::uint64_t k = 1; k < 100; ++k) {
        EXPECT_NE(cycle(k, true).reason, StopReason::own_stop) << k;
    }
}

}  // namespace
}  // namespace axg::test
