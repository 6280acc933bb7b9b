// SPDX-License-Identifier: Apache-2.0
// The deployed guard under a clock that is passed in: its timers fire between frames when the live
// guard's would, a result comes as late as its caller says, and a new start has nothing of the old.
#include "hil_replay/guard/timed_guard.hpp"

#include <gtest/gtest.h>

#include "tests/support/timed_world.hpp"

namespace axg {
namespace {

using test::TimedWorld;

constexpr std::uint64_t kSamplesToReady = 40;

void expect_armed(TimedWorld& world) {
    world.start();
    world.run_samples(kSamplesToReady);
    ASSERT_EQ(world.phase(), GuardPhase::armed) << to_text(world.cause());
}

TEST(TimedGuard, PermitsEverySampleOfAHealthyBoard) {
    TimedWorld world;
    expect_armed(world);
    const std::int64_t from_us = world.guard->now_us() + 1;
    const std::uint64_t cycles = world.cycles;
    world.run_samples(500);
    const auto permits = world.with_id(world.machine.can.permit_id, from_us);
    EXPECT_EQ(permits.size(), 500U);
    EXPECT_EQ(permits.front().data[7], 0x30) << "n";
    EXPECT_EQ(world.with_id(world.machine.can.permit_id + 1, from_us).size(), 500U);
    EXPECT_EQ(world.cycles - cycles, 500U);
    EXPECT_EQ(world.permitted, world.guard->guard().counters().permits);
    EXPECT_TRUE(world.with_id(world.machine.can.stop_id).empty());
}

// A pair of permits on the bus holds up the board's next frames. After a sample that was lost there
// is none, so the next is complete 265 us sooner than usual, and before its period has begun.
TEST(TimedGuard, ALostSampleCostsItsOwnPermitAlone) {
    constexpr std::int64_t kHeldUpUs = 265;
    constexpr int kSamples = 200, kLostEvery = 10;
    TimedWorld world;
    world.response_us = world.machine.deadline_us;
    world.start();
    bool was_lost = false;
    std::int64_t armed_us = 0;
    std::size_t expected = 0;
    for (int i = 0; i < static_cast<int>(kSamplesToReady) + kSamples; ++i) {
        const bool counts = i >= static_cast<int>(kSamplesToReady);
        const bool is_lost = counts && i % kLostEvery == 0;
        std::vector<CanFrame> frames = world.next_sample();
        if (is_lost) {
            frames.erase(frames.begin() + 1);  // the first after the SYNC
        }
        for (CanFrame& frame : frames) {
            frame.time_us += was_lost ? 0 : kHeldUpUs;
            world.run_before(frame.time_us);
            world.guard->arrive({.frame = frame});
        }
        was_lost = is_lost;
        armed_us = counts ? armed_us : world.newest_us() + world.machine.can.sample_us;
        expected += counts && !is_lost ? 1 : 0;
    }
    world.run_before(world.newest_us() + world.machine.can.sample_us);
    ASSERT_EQ(world.phase(), GuardPhase::armed) << to_text(world.cause());
    EXPECT_EQ(world.with_id(world.machine.can.permit_id, armed_us).size(), expected);
}

// Live, the first timer after the age limit finds stale input. A board that is silent for ever and
// one that speaks again much later are stopped at the same instant, and no frame is needed for it.
TEST(TimedGuard, StaleInputInMotionStopsBetweenFrames) {
    std::int64_t stop_us[2] = {0, 0};
    for (const bool speaks_again : {false, true}) {
        TimedWorld world;
        expect_armed(world);
        const std::int64_t last_us = world.newest_us();
        const std::int64_t age_us = world.machine.can.stale_after_us;
        world.run_before(last_us + age_us);
        EXPECT_EQ(world.phase(), GuardPhase::armed) << "no older than it may be";
        if (speaks_again) {
            CanFrame sync = encode_sync(world.machine.can.sync_id, 7, last_us + 100'000);
            world.guard->arrive({.frame = sync});
        } else {
            world.run_before(last_us + 100'000);
        }
        const auto stops = world.with_id(world.machine.can.stop_id);
        ASSERT_FALSE(stops.empty());
        stop_us[speaks_again ? 1 : 0] = stops.front().time_us;
        EXPECT_GE(stops.front().time_us, last_us + age_us);
        EXPECT_LE(stops.front().time_us, last_us + age_us + world.machine.can.sample_us);
        EXPECT_GT(stops.size(), 90U) << "and again each period";
    }
    EXPECT_EQ(stop_us[0], stop_us[1]);
}

TEST(TimedGuard, AResultComesWhenItsEngineIsDone) {
    TimedWorld world;
    world.response_us = 300;
    expect_armed(world);
    const std::vector<CanFrame> sample = world.next_sample();
    std::int64_t arrived_us = 0;  // of the last axis frame; a heartbeat may follow
    for (const CanFrame& frame : sample) {
        world.guard->arrive({.frame = frame});
        arrived_us = frame.id == world.machine.can.axis_ids.back() ? frame.time_us : arrived_us;
    }
    world.run_before(arrived_us + 300);
    EXPECT_TRUE(world.with_id(world.machine.can.permit_id, arrived_us).empty());
    EXPECT_EQ(world.guard->next_due_us(), arrived_us + 300);
    world.run_before(arrived_us + 301);
    const auto permits = world.with_id(world.machine.can.permit_id, arrived_us);
    ASSERT_EQ(permits.size(), 1U);
    EXPECT_EQ(permits[0].time_us, arrived_us + 300);
    EXPECT_EQ(permits[0].data[1], sample[0].data[0]) << "of this sample";
}

TEST(TimedGuard, AResultAfterTheDeadlineIsCountedAndNoPermit) {
    TimedWorld world;
    world.response_us = world.machine.deadline_us;
    expect_armed(world);
    EXPECT_EQ(world.guard->guard().counters().late, 0U) << "at the deadline is in time";
    const std::int64_t from_us = world.guard->now_us() + 1;
    const std::uint64_t permitted = world.permitted;
    world.run_samples(1);
    world.response_us += 1;
    world.run_samples(1);
    EXPECT_EQ(world.guard->guard().counters().late, 0U) << "its result is still on its way";
    world.response_us -= 1;
    world.run_samples(3);
    EXPECT_EQ(world.guard->guard().counters().late, 1U);
    world.run_before(world.newest_us() + 990);
    EXPECT_EQ(world.with_id(world.machine.can.permit_id, from_us).size(), 5U)
        << "that of the sample before, and of all but the late one";
    EXPECT_EQ(world.permitted - permitted, 5U);
    EXPECT_EQ(world.phase(), GuardPhase::armed);
}

TEST(TimedGuard, AnEngineThatIsAlwaysLateIsNeverArmed) {
    TimedWorld world;
    world.response_us = world.machine.deadline_us + 1;
    world.start();
    world.run_samples(200);
    EXPECT_EQ(world.phase(), GuardPhase::selftest);
    EXPECT_FALSE(world.guard->was_armed());
    EXPECT_GT(world.guard->guard().counters().late, 190U);
    EXPECT_EQ(world.permitted, 0U);
}

// What the wire does not give back was not sent, for all the guard knows.
TEST(TimedGuard, AMissingEchoStops) {
    TimedWorld world;
    world.options.echoes = false;
    expect_armed(world);
    world.run_samples(50);
    ASSERT_EQ(world.phase(), GuardPhase::armed) << "echoes came by arrive()";
    world.run_before(world.newest_us() + 990);  // the twin is out, and seen
    world.echoes = false;
    const std::int64_t limit_us = 2 * std::int64_t{world.machine.can.sample_us};
    const std::int64_t from_us = world.guard->now_us() + 1;
    world.run_samples(1);
    const auto permits = world.with_id(world.machine.can.permit_id, from_us);
    ASSERT_EQ(permits.size(), 1U);
    world.run_samples(1);
    world.run_before(permits[0].time_us + limit_us + 1);
    EXPECT_EQ(world.phase(), GuardPhase::armed);
    world.run_before(permits[0].time_us + limit_us + 2);
    EXPECT_EQ(world.phase(), GuardPhase::stopped);
    EXPECT_EQ(world.cause(), GuardFault::output) << to_text(world.cause());
    EXPECT_EQ(world.guard->guard().counters().send_faults, 1U);
    const auto twins = world.with_id(world.machine.can.permit_id + 1, from_us);
    ASSERT_EQ(twins.size(), 1U) << "a twin waits for the echo of its plain frame";
    EXPECT_EQ(twins[0].data[0], 0xA5) << "that of the word stop";
}

TEST(TimedGuard, AnswersHashesForABoardThatDoesNot) {
    TimedWorld world;
    world.machine.can.hashes_in_id = 0x582;
    world.machine.can.hashes_out_id = 0x602;
    world.options.guard.hashes.of = {1, 2, 3, 4};
    expect_armed(world);
    EXPECT_EQ(world.with_id(0x602).size(), kHashParts) << "each is asked for once";
}

TEST(TimedGuard, LeavesHashesToABoardThatAnswersItself) {
    TimedWorld world;
    world.machine.can.hashes_in_id = 0x582;
    world.machine.can.hashes_out_id = 0x602;
    world.options.answers_hashes = false;
    world.start();
    world.run_samples(200);
    EXPECT_EQ(world.phase(), GuardPhase::selftest);
    EXPECT_GT(world.with_id(0x602).size(), 10U) << "it asks on";
}

TEST(TimedGuard, IsArmedNotBeforeItsTime) {
    TimedWorld world;
    const std::int64_t from_us = TimedWorld::kBeginUs + 123'456;
    world.options.arm_from_us = from_us;
    std::int64_t armed_us = 0;
    world.options.noted = [&](const LiveNote& note) {
        if (note.kind == LiveNote::Kind::phase && note.phase == GuardPhase::armed) {
            armed_us = note.time_us;
        }
    };
    world.start();
    world.run_samples(100);
    EXPECT_EQ(world.phase(), GuardPhase::ready);
    world.run_samples(100);
    EXPECT_TRUE(world.guard->was_armed());
    EXPECT_GE(armed_us, from_us);
    EXPECT_LE(armed_us, from_us + world.machine.can.sample_us);
    const auto permits = world.with_id(world.machine.can.permit_id);
    ASSERT_FALSE(permits.empty());
    EXPECT_GE(permits[0].time_us, from_us);
}

TEST(TimedGuard, IsNeverArmedWhereNobodyArms) {
    TimedWorld world;
    world.options.arm_from_us = INT64_MAX;
    world.start();
    world.run_samples(300);
    EXPECT_EQ(world.phase(), GuardPhase::ready);
    EXPECT_FALSE(world.guard->was_armed());
    EXPECT_TRUE(world.with_id(world.machine.can.permit_id).empty());
}

// The result that was on its way at the restart belongs to nobody, and the stop is forgotten.
TEST(TimedGuard, ARestartClearsTheLatchAndWhatWaits) {
    TimedWorld world;
    world.response_us = 400;
    expect_armed(world);
    world.answers.is_well = false;
    world.run_samples(2);
    ASSERT_TRUE(world.guard->is_stopped());
    EXPECT_EQ(world.cause(), GuardFault::verdict);
    EXPECT_EQ(world.guard->guard().reason(), StopReason::known_answer);
    world.answers.is_well = true;
    world.run_samples(1);
    const std::uint64_t cycles = world.cycles;
    const std::int64_t restart_us = world.guard->now_us() + 10;
    world.guard->restart(restart_us);
    EXPECT_FALSE(world.guard->is_stopped());
    EXPECT_FALSE(world.guard->was_armed());
    EXPECT_EQ(world.phase(), GuardPhase::selftest);
    EXPECT_EQ(world.guard->guard().counters().permits, 0U);
    world.run_before(restart_us + 900);
    EXPECT_EQ(world.cycles, cycles) << "the result that waited is gone";
    const std::size_t sent = world.with_id(world.machine.can.stop_id, restart_us).size();
    EXPECT_EQ(sent, 0U) << "so is the stop";
    world.run_samples(100 + kSamplesToReady);  // after the board's next session frame
    EXPECT_EQ(world.phase(), GuardPhase::armed) << to_text(world.cause());
    const auto permits = world.with_id(world.machine.can.permit_id, restart_us);
    ASSERT_FALSE(permits.empty());
    EXPECT_EQ(permits[0].data[2], 1) << "a new process counts its permits from the beginning";
}

TEST(TimedGuard, AFrameOfThePastIsReadNow) {
    TimedWorld world;
    expect_armed(world);
    const std::int64_t now_us = world.guard->now_us();
    world.guard->arrive({.frame = encode_sync(0x7F0, 1, now_us - 5000)});
    EXPECT_EQ(world.guard->now_us(), now_us);
    EXPECT_EQ(world.phase(), GuardPhase::armed);
}

}  // namespace
}  // namespace axg
