// SPDX-License-Identifier: Apache-2.0
// The live guard between a healthy board and an engine, and what it does when either, the wire or
// the process itself fails: what leaves on the wire is judged as the board would judge it.
#include "firmware_if/guard/guard_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "firmware_if/system/gpio_line.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/permit_reader.hpp"

namespace axg {
namespace {

class GuardNodeTest : public testing::TestWithParam<CanFormat> {
  protected:
    const Guard& guard() const { return world.guard->guard(); }
    std::size_t permits_since(std::int64_t from_us) const { return world.count_permits(from_us); }
    /// Stopped for this cause, the first stop within a millisecond of `fault_us`, and after it no
    /// permit; stored.
    void expect_stopped(GuardFault cause, std::int64_t fault_us) {
        EXPECT_EQ(guard().phase, GuardPhase::stopped);
        EXPECT_EQ(guard().cause, cause) << to_text(guard().cause);
        EXPECT_TRUE(is_latched(latch));
        std::int64_t stop_us = 0;
        for (const CanFrame& frame : world.wire.sent) {
            if (frame.id == world.machine.can.stop_id && frame.time_us >= fault_us) {
                stop_us = frame.time_us;
                break;
            }
        }
        ASSERT_NE(stop_us, 0) << "no stop was sent";
        EXPECT_LE(stop_us - fault_us, 1000);
        EXPECT_EQ(permits_since(stop_us), 0U);
        EXPECT_EQ(world.count_permits(stop_us, true), 0U);
    }
    /// The board stands, a person resets and arms: permits again.
    void expect_recovery() {
        world.stands_still = true;
        world.run_periods(world.kStandPeriods);
        world.guard->reset(world.wire.now_us);
        EXPECT_FALSE(is_latched(latch));
        EXPECT_EQ(guard().phase, GuardPhase::selftest) << to_text(guard().cause);
        world.stands_still = false;
        world.run_periods(140);  // until the board's next session frame
        EXPECT_EQ(guard().phase, GuardPhase::ready) << "a reset permits nothing by itself";
        const std::int64_t armed_us = world.wire.now_us;
        world.guard->arm(armed_us);
        world.run_periods(50);
        EXPECT_GE(permits_since(armed_us), 48U);
    }
    void arm() {
        world.run_to_armed();
        world.run_periods(50);
        ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{GetParam(), latch};
};

TEST_P(GuardNodeTest, PermitsEverySampleAfterAPersonHasArmed) {
    world.run_periods(100);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_EQ(permits_since(0), 0U) << "nobody has armed";
    EXPECT_GT(world.count_sent(world.machine.can.heartbeat_out_id), 8U);
    const std::int64_t armed_us = world.wire.now_us;
    world.guard->arm(armed_us);
    world.run_periods(1000);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    EXPECT_GE(permits_since(armed_us), 998U);
    test::PermitReader reader(world.machine.can);
    std::size_t permits = 0;
    for (const CanFrame& frame : world.wire.sent) {
        permits += reader.on_frame(frame) ? 1U : 0U;
    }
    EXPECT_GE(permits, 997U);
    EXPECT_EQ(world.count_sent(world.machine.can.stop_id), 0U);
    EXPECT_EQ(world.guard->counters().late, 0U);
}

TEST_P(GuardNodeTest, ThePermitCarriesTheSpeedCapOfItsResult) {
    world.verdict = [](std::uint64_t sample) {
        CycleResult result{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
        result.advisories.speed_cap = static_cast<std::uint8_t>(1 + sample % kSpeedCapRapid);
        return result;
    };
    arm();
    const std::uint64_t before = world.count_sent(world.machine.can.permit_id);
    world.run_periods(300);
    std::set<int> caps;
    for (const CanFrame& frame : world.wire.sent) {
        if (frame.id == world.machine.can.permit_id) {
            caps.insert(frame.data[5]);
        }
    }
    EXPECT_GE(world.count_sent(world.machine.can.permit_id), before + 298);
    EXPECT_EQ(caps.size(), kSpeedCapRapid) << "every cap from 1 to 250";
}

TEST_P(GuardNodeTest, ThePermitSaysSlowWhileAClearanceLevelIsSlow) {
    arm();
    world.verdict = [](std::uint64_t) {
        CycleResult result{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
        result.advisories.clearance_level = ClearanceLevel::slow;
        result.advisories.pair = 2;
        result.advisories.distance_mm = 1.26;
        return result;
    };
    world.run_periods(2);
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(100);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << "slow is a permit";
    std::size_t slow = 0;
    for (const CanFrame& frame : world.wire.sent) {
        if (frame.time_us >= from_us && frame.id == world.machine.can.permit_id) {
            EXPECT_EQ(frame.data[0], 0xC3);
            EXPECT_EQ(frame.data[7], 0x32) << "n, and the level slow";
            ++slow;
        }
    }
    EXPECT_GE(slow, 98U);
    EXPECT_GE(world.guard->counters().slow, slow);
    EXPECT_LT(world.guard->counters().slow, world.guard->counters().permits);
}

// A machine that stands too near for a proof: before the first permit the guard waits, whether the
// proof is missing for long or comes and goes; after it a missing proof is a stop.
TEST_P(GuardNodeTest, WhatIsNotProvenBeforeArmingLatchesNothing) {
    std::function<bool(std::uint64_t)> is_proven = [](std::uint64_t) { return true; };
    world.verdict = [&](std::uint64_t sample) {
        const auto proof = is_proven(sample) ? JointBoxProof::proven : JointBoxProof::budget_spent;
        const PairProof pair{
            0, kNoIndex, {proof, QueryStatus::ok, 1, {}}, {QueryStatus::ok, Containment::none}};
        return judge({.status = SnapshotStatus::ok,
                      .known_answer_signature = kKnownAnswerSignature,
                      .is_settled = true,
                      .samples = 3,
                      .proofs = {&pair, 1}},
                     true, world.is_armed);
    };
    world.run_periods(40);
    is_proven = [](std::uint64_t) { return false; };
    world.run_periods(200);
    EXPECT_EQ(guard().phase, GuardPhase::selftest) << to_text(guard().cause);
    is_proven = [](std::uint64_t sample) { return sample % 50 >= 25 || sample % 2 == 0; };
    world.run_periods(500);
    is_proven = [](std::uint64_t) { return true; };
    world.run_periods(100);
    ASSERT_EQ(guard().phase, GuardPhase::ready) << to_text(guard().cause);
    EXPECT_EQ(world.count_sent(world.machine.can.stop_id), 0U);
    arm();
    world.run_periods(5);
    is_proven = [](std::uint64_t) { return false; };
    world.run_periods(2);
    EXPECT_EQ(guard().cause, GuardFault::verdict);
    EXPECT_EQ(world.guard->reason(), StopReason::predicted);
}

TEST_P(GuardNodeTest, TheStopIsFirstAndGoesOnUntilTheBoardStands) {
    arm();
    world.verdict = [](std::uint64_t) {
        return CycleResult{.is_stop = true, .reason = StopReason::predicted, .pair = 3};
    };
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(2);
    world.verdict = [](std::uint64_t) { return CycleResult{}; };
    world.run_periods(20);
    EXPECT_EQ(guard().cause, GuardFault::verdict);
    const auto first =
        std::find_if(world.wire.sent.begin(), world.wire.sent.end(), [&](const CanFrame& f) {
            return f.time_us >= from_us && f.id == world.machine.can.stop_id;
        });
    ASSERT_NE(first, world.wire.sent.end());
    EXPECT_EQ(permits_since(first->time_us), 0U);
    EXPECT_GE(world.count_sent(world.machine.can.stop_id), 20U) << "one a period";
    Emergency emergency;
    const auto told = std::find_if(first, world.wire.sent.end(), [&](const CanFrame& f) {
        return f.id == world.machine.can.emergency_id;
    });
    ASSERT_NE(told, world.wire.sent.end());
    EXPECT_EQ(decode_emergency(world.machine.can, *told, emergency), GuardFrameStatus::ok);
    EXPECT_EQ(emergency.code, EmergencyCode::predicted_collision);
    EXPECT_EQ(emergency.pair, 3);
    world.guard->reset(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::stopped) << "the board still moves";
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    const std::size_t stops = world.count_sent(world.machine.can.stop_id);
    world.run_periods(20);
    EXPECT_EQ(world.count_sent(world.machine.can.stop_id), stops) << "the board has confirmed";
    world.verdict = [](std::uint64_t) { return CycleResult{.has_permit = true}; };
    expect_recovery();
}

// Within a margin nothing but a jog is proven: reset, self-test and arm lead to its own word.
TEST_P(GuardNodeTest, AJogLeadsOutOnTheSameWayWithAWordOfItsOwn) {
    arm();
    world.verdict = [](std::uint64_t) {
        return CycleResult{.is_stop = true, .reason = StopReason::predicted};
    };
    world.run_periods(5);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    world.stands_still = true;
    world.verdict = [](std::uint64_t) { return CycleResult{.reason = StopReason::predicted}; };
    world.run_periods(world.kStandPeriods);
    world.guard->reset(world.wire.now_us);
    world.run_periods(40);
    EXPECT_EQ(guard().phase, GuardPhase::selftest) << "nothing is proven: never ready";
    world.verdict = [](std::uint64_t) {
        return CycleResult{
            .has_permit = true, .known_answer_signature = kKnownAnswerSignature, .is_jog = true};
    };
    world.run_periods(40);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    const std::int64_t armed_us = world.wire.now_us;
    world.guard->arm(armed_us);
    world.run_periods(50);
    EXPECT_GE(permits_since(armed_us), 48U);
    for (const CanFrame& frame : world.wire.sent) {
        if (frame.id == world.machine.can.permit_id && frame.time_us >= armed_us) {
            EXPECT_EQ(frame.data[0], 0x3C);
        }
    }
}

TEST_P(GuardNodeTest, ASilentEngineStops) {
    arm();
    world.engine_runs = false;
    const std::int64_t from_us = world.wire.now_us;
    const std::size_t sent = permits_since(0);
    world.run_periods(10);
    EXPECT_LE(permits_since(0), sent + 1) << "an answer may have been given before";
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    const std::int64_t limit_us =
        (world.machine.can.permit_samples.most + 1) * std::int64_t{world.machine.can.sample_us};
    EXPECT_GE(world.count_sent(world.machine.can.stop_id, from_us), 1U);
    expect_stopped(guard().cause, from_us + limit_us - 1000);
    EXPECT_TRUE(guard().cause == GuardFault::silence || guard().cause == GuardFault::engine);
    world.engine_runs = true;
    expect_recovery();
}

TEST_P(GuardNodeTest, AResultAfterTheDeadlineIsNoPermit) {
    arm();
    world.response_us = world.machine.deadline_us + 50;
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(2);
    EXPECT_LE(permits_since(from_us), 1U);
    EXPECT_GE(world.guard->counters().late, 1U);
    world.run_periods(5);
    EXPECT_EQ(guard().cause, GuardFault::silence);
}

TEST_P(GuardNodeTest, AFrameThatIsNotSeenOnTheBusStops) {
    arm();
    world.wire.is_deaf = true;
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(5);
    EXPECT_GT(world.wire.applied, 0U);
    expect_stopped(GuardFault::output, from_us + 2000);
    world.wire.is_deaf = false;
    expect_recovery();
}

TEST_P(GuardNodeTest, ARefusedFrameStops) {
    for (const SendStatus status : {SendStatus::busy, SendStatus::down, SendStatus::failed}) {
        arm();
        world.wire.reply = status;
        world.run_periods(5);
        EXPECT_GT(world.wire.applied, 0U);
        EXPECT_EQ(guard().cause, GuardFault::output);
        world.wire.reply = SendStatus::ok;
        const std::int64_t from_us = world.wire.now_us;
        world.run_periods(2);
        expect_stopped(GuardFault::output, from_us);
        expect_recovery();
        set_latch(latch, false);
        world.start();
    }
}

TEST_P(GuardNodeTest, AnInterfaceThatGoesDownStopsAndStaysStopped) {
    arm();
    world.wire.inject(ReadStatus::down);
    const std::int64_t from_us = world.wire.now_us;
    world.passes = [](const CanFrame&) { return false; };
    world.run_periods(20);
    expect_stopped(GuardFault::input, from_us);
    world.guard->reset(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::stopped) << "it is still down";
    world.passes = [](const CanFrame&) { return true; };
    world.run_periods(20);
    EXPECT_EQ(guard().phase, GuardPhase::stopped) << "up again resets nothing";
    expect_recovery();
}

TEST_P(GuardNodeTest, ARemovedInterfaceIsTheEnd) {
    arm();
    world.wire.inject(ReadStatus::gone);
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(2);
    EXPECT_TRUE(world.guard->is_wire_gone());
    expect_stopped(GuardFault::input, from_us);
}

TEST_P(GuardNodeTest, AFrameOfOursFromAnotherSenderStops) {
    const CanLayout& can = world.machine.can;
    for (const std::uint32_t id :
         {can.permit_id, can.permit_id + 1, can.emergency_id, can.heartbeat_out_id}) {
        arm();
        CanFrame foreign;
        foreign.id = id;
        foreign.length_bytes = 1;
        foreign.time_us = world.wire.now_us;
        world.wire.arrive(foreign);
        const std::int64_t from_us = world.wire.now_us;
        world.run_periods(2);
        expect_stopped(GuardFault::second_guard, from_us);
        expect_recovery();
        world.guard->end();
        world.start();
    }
}

TEST_P(GuardNodeTest, AHeldProcessStopsBeforeItPermitsAnything) {
    arm();
    world.is_held = true;
    world.run_periods(20);
    world.is_held = false;
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(5);
    expect_stopped(GuardFault::gap, from_us);
    EXPECT_EQ(permits_since(from_us), 0U);
    expect_recovery();
}

TEST_P(GuardNodeTest, ABoardThatFallsSilentStops) {
    arm();
    world.passes = [](const CanFrame&) { return false; };
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(10);
    expect_stopped(guard().cause, from_us + 2000);
    EXPECT_TRUE(guard().cause == GuardFault::input || guard().cause == GuardFault::silence);
    world.passes = [](const CanFrame&) { return true; };
    expect_recovery();
}

TEST_P(GuardNodeTest, AStopOutlivesTheProcess) {
    arm();
    world.guard->report(GuardFault::refused, world.wire.now_us);
    EXPECT_TRUE(is_latched(latch));
    world.start();
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::latched);
    world.run_periods(30);
    world.guard->arm(world.wire.now_us);
    world.run_periods(30);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    expect_recovery();
}

TEST_P(GuardNodeTest, AGuardThatIsKilledBeforeItIsArmedBeginsAnew) {
    world.run_periods(100);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    world.start();
    world.run_periods(100);
    EXPECT_EQ(guard().phase, GuardPhase::ready);
    EXPECT_EQ(permits_since(0), 0U);
}

TEST_P(GuardNodeTest, AFloodIsReadInBoundedParts) {
    arm();
    CanFrame foreign;
    foreign.id = 0x7AA;
    foreign.time_us = world.wire.now_us;
    for (std::uint32_t i = 0; i < 10 * GuardNode::kFramesATurn; ++i) {
        world.wire.arrive(foreign);
    }
    const std::uint64_t before = world.guard->receiver().counters().frames;
    world.guard->turn(world.wire.now_us);
    EXPECT_LE(world.guard->receiver().counters().frames - before, GuardNode::kFramesATurn);
    EXPECT_LE(world.guard->next_due_us(), world.wire.now_us) << "the rest is due at once";
    world.run_periods(20);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
}

TEST_P(GuardNodeTest, AResultFromBeforeAResetSaysNothing) {
    arm();
    world.verdict = [](std::uint64_t) {
        return CycleResult{.is_stop = true, .reason = StopReason::contact};
    };
    world.response_us = 180'000;  // submitted now, done when all is over
    world.run_periods(2);
    world.verdict = [](std::uint64_t) { return CycleResult{.has_permit = true}; };
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    EXPECT_NE(guard().cause, GuardFault::verdict);
    world.guard->reset(world.wire.now_us);
    ASSERT_EQ(guard().phase, GuardPhase::selftest);
    world.response_us = 200;
    world.run_periods(2);
    const std::int64_t reset_us = world.wire.now_us;
    world.run_periods(200);
    EXPECT_NE(guard().cause, GuardFault::verdict) << "of another life";
    EXPECT_EQ(permits_since(reset_us), 0U);
}

TEST_P(GuardNodeTest, AResetIsRefusedWhileTheInterfaceIsDown) {
    arm();
    world.guard->report(GuardFault::refused, world.wire.now_us);
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    ASSERT_TRUE(guard().is_confirmed);
    world.passes = [](const CanFrame&) { return false; };
    world.run_periods(3);
    world.wire.inject(ReadStatus::down);
    world.wire.reply = SendStatus::busy;  // not even an echo comes
    for (int i = 0; i < 30; ++i) {        // between two heartbeats that fail nothing else is wrong
        world.run_periods(1);
        world.guard->reset(world.wire.now_us);
        ASSERT_EQ(guard().phase, GuardPhase::stopped) << i;
    }
}

TEST_P(GuardNodeTest, AFrameFromBeforeTheStopConfirmsNothing) {
    world.stands_still = true;
    arm();
    world.is_held = true;
    world.run_periods(20);
    world.is_held = false;
    world.passes = [](const CanFrame&) { return false; };
    world.guard->turn(world.wire.now_us);  // the stop, and then frames of the time before
    EXPECT_EQ(guard().cause, GuardFault::gap);
    EXPECT_FALSE(guard().is_confirmed);
}

TEST_P(GuardNodeTest, ASilentEngineIsFoundBeforeAnybodyArms) {
    world.run_periods(40);
    ASSERT_EQ(guard().phase, GuardPhase::ready);
    world.engine_runs = false;
    world.run_periods(10);
    EXPECT_EQ(guard().cause, GuardFault::engine);
}

TEST(QuickStop, GoesToEachDriveWithEveryStopAndToNobodyBefore) {
    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::classical, latch};
    world.machine.can.quick_stop_ids = {0x303, 0x304};
    world.run_to_armed();
    world.run_periods(50);
    ASSERT_EQ(world.guard->guard().phase, GuardPhase::armed);
    EXPECT_EQ(world.count_sent(0x303) + world.count_sent(0x304), 0U);
    world.verdict = [](std::uint64_t) {
        return CycleResult{.is_stop = true, .reason = StopReason::predicted, .pair = 3};
    };
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(20);
    const std::size_t stops = world.count_sent(world.machine.can.stop_id, from_us);
    EXPECT_GE(stops, 18U);
    EXPECT_EQ(world.count_sent(0x303, from_us), stops);
    EXPECT_EQ(world.count_sent(0x304, from_us), stops);
    std::int64_t stop_us = 0, drive_us = 0;
    for (const CanFrame& frame : world.wire.sent) {
        if (frame.id == world.machine.can.stop_id && stop_us == 0) {
            stop_us = frame.time_us;
        } else if (frame.id == 0x304 && drive_us == 0) {
            drive_us = frame.time_us;
            EXPECT_EQ(frame.length_bytes, 2);
            EXPECT_EQ(frame.data[0] & 0x86, 0x02) << "CiA 402: 0xxx x01x is quick stop";
            EXPECT_EQ(frame.data[1], 0);
        }
    }
    EXPECT_EQ(drive_us, stop_us) << "in the same turn";
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    const std::size_t confirmed = world.count_sent(0x303);
    world.run_periods(30);
    EXPECT_EQ(world.count_sent(0x303), confirmed) << "the board has confirmed";
}

TEST(QuickStop, FromAnotherSenderIsASecondGuard) {
    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::classical, latch};
    world.machine.can.quick_stop_ids = {0x303};
    world.run_to_armed();
    world.run_periods(50);
    world.wire.arrive(encode_quick_stop(0x303, world.wire.now_us));
    world.run_periods(2);
    EXPECT_EQ(world.guard->guard().cause, GuardFault::second_guard);
}

TEST(QuickStop, IdsAreAmongThoseThatTheSocketLetsThrough) {
    Machine machine = test::five_axis_machine(CanFormat::classical);
    machine.can.quick_stop_ids.assign(kAxesMax, 0);
    for (std::uint32_t i = 0; i < kAxesMax; ++i) {
        machine.can.quick_stop_ids[i] = 0x300 + i;
    }
    std::array<std::uint32_t, kLiveIdsMax> ids{};
    const std::uint32_t count = live_ids(machine, ids);
    for (const std::uint32_t id : machine.can.quick_stop_ids) {
        EXPECT_EQ(std::count(ids.begin(), ids.begin() + count, id), 1) << id;
    }
}

/// A line that keeps its edges, and that may fail.
class FakeLine final : public PulseLine {
  public:
    [[nodiscard]] bool set(bool is_high) noexcept override {
        edges += is_high != level ? 1 : 0;
        level = is_high;
        return works;
    }
    bool level = false, works = true;
    std::uint64_t edges = 0;
};

TEST(TheOutputLine, HasOneEdgeWithEachPermitAndNoneWithoutAndIsLowAfterAStop) {
    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::classical, latch};
    FakeLine line;
    world.options.line = &line;
    world.start();
    world.run_periods(100);
    ASSERT_EQ(world.guard->guard().phase, GuardPhase::ready);
    EXPECT_EQ(line.edges, 0U) << "alive, healthy, and nobody has armed";
    world.guard->arm(world.wire.now_us);
    world.run_periods(101);
    const std::uint64_t permits = world.guard->counters().permits;
    EXPECT_GE(permits, 99U);
    EXPECT_EQ(line.edges, permits);
    world.engine_runs = false;  // the bus thread lives on
    const std::uint64_t before = line.edges;
    world.run_periods(2);
    EXPECT_LE(line.edges - before, 1U) << "one answer was on its way";
    world.run_periods(20);
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::stopped);
    EXPECT_FALSE(line.level);
    EXPECT_LE(line.edges - before, 2U) << "at most the edge down";
}

TEST(TheOutputLine, ThatCannotBeSetStops) {
    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::classical, latch};
    FakeLine line;
    world.options.line = &line;
    world.start();
    world.run_to_armed();
    world.run_periods(50);
    ASSERT_EQ(world.guard->guard().phase, GuardPhase::armed);
    line.works = false;
    const std::int64_t from_us = world.wire.now_us;
    world.run_periods(2);
    EXPECT_EQ(world.guard->guard().phase, GuardPhase::stopped);
    EXPECT_EQ(world.guard->guard().cause, GuardFault::output);
    EXPECT_GE(world.count_sent(world.machine.can.stop_id, from_us), 1U);
}

TEST(TheOutputLine, ThatIsNoneIsRefusedInWords) {
    std::string fault;
    EXPECT_FALSE(GpioLine::open("/dev/null", 3, fault).has_value());
    EXPECT_NE(fault.find("/dev/null, line 3: "), std::string::npos) << fault;
    EXPECT_NE(fault.find("gpioinfo"), std::string::npos) << fault;
    EXPECT_FALSE(GpioLine::open("/nowhere/gpiochip0", 3, fault).has_value());
    EXPECT_NE(fault.find("ls -l /dev/gpiochip"), std::string::npos) << fault;
}

INSTANTIATE_TEST_SUITE_P(Formats, GuardNodeTest,
                         testing::Values(CanFormat::classical, CanFormat::fd),
                         [](const auto& tested) {
                             return tested.param == CanFormat::fd ? "fd" : "classical";
                         });

}  // namespace
}  // namespace axg
