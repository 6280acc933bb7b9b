// SPDX-License-Identifier: Apache-2.0
// A stop frame of another sender stops the board, so it stops the guard as well: whatever its
// length and format, as a board obeys it. The guard's own stop, seen on the bus, is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/support/live_world.hpp"

namespace axg {
namespace {

class ForeignStop : public testing::Test {
  protected:
    const Guard& guard() const { return world.guard->guard(); }
    CanFrame stop_frame(std::uint8_t length_bytes = 0) const {
        CanFrame frame;
        frame.id = world.machine.can.stop_id;
        frame.length_bytes = length_bytes;
        frame.time_us = world.wire.now_us;
        return frame;
    }
    void arm() {
        world.run_to_armed();
        world.run_periods(20);
        ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    }
    void start_anew() {
        set_latch(latch, false);
        world.start();
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{CanFormat::fd, latch};
};

TEST_F(ForeignStop, OfAnyLengthAndFormatStopsInItsTurn) {
    CanFrame flexible = stop_frame(64);
    flexible.fd = true;
    for (CanFrame frame : {stop_frame(0), stop_frame(1), stop_frame(8), flexible}) {
        arm();
        const std::int64_t from_us = world.wire.now_us;
        frame.time_us = from_us;
        world.wire.arrive(frame);
        world.run_periods(1);
        EXPECT_EQ(guard().phase, GuardPhase::stopped) << int{frame.length_bytes};
        EXPECT_EQ(guard().cause, GuardFault::foreign_stop) << to_text(guard().cause);
        EXPECT_TRUE(is_latched(latch));
        EXPECT_GE(world.count_sent(world.machine.can.stop_id, from_us), 1U);
        start_anew();
    }
}

TEST_F(ForeignStop, StopsInEachPhase) {
    const auto expect_stop = [&](GuardPhase phase) {
        ASSERT_EQ(guard().phase, phase);
        world.wire.arrive(stop_frame());
        world.guard->turn(world.wire.now_us);
        EXPECT_EQ(guard().cause, GuardFault::foreign_stop) << to_text(phase);
        start_anew();
    };
    expect_stop(GuardPhase::selftest);
    world.run_periods(100);
    expect_stop(GuardPhase::ready);
}

TEST_F(ForeignStop, ThatGoesOnKeepsAPersonFromResetting) {
    arm();
    world.wire.arrive(stop_frame());
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    ASSERT_TRUE(guard().is_confirmed);
    for (int i = 0; i < 10; ++i) {
        world.wire.arrive(stop_frame());
        world.run_periods(1);
        world.guard->reset(world.wire.now_us);
        ASSERT_EQ(guard().phase, GuardPhase::stopped) << "a fault is still present";
    }
    world.run_periods(5);
    world.guard->reset(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::selftest);
}

TEST_F(ForeignStop, IsNoneOfTheGuardsOwnAndNoOtherKindOfFrame) {
    arm();
    world.guard->report(GuardFault::engine, world.wire.now_us);
    world.run_periods(50);
    EXPECT_GE(world.guard->counters().echoes, 50U) << "its own stops came back";
    EXPECT_EQ(guard().cause, GuardFault::engine);
    world.stands_still = true;
    world.run_periods(world.kStandPeriods);
    world.guard->reset(world.wire.now_us);
    EXPECT_EQ(guard().phase, GuardPhase::selftest) << "an own stop is no fault";
    world.run_periods(100);
    CanFrame extended = stop_frame(), remote = stop_frame(), error = stop_frame();
    extended.extended = remote.remote = error.error = true;
    for (CanFrame frame : {extended, remote, error}) {
        frame.time_us = world.wire.now_us;
        world.wire.arrive(frame);
        world.run_periods(1);
        EXPECT_NE(guard().phase, GuardPhase::stopped);
    }
}

TEST_F(ForeignStop, IsNamedInTheLog) {
    arm();
    LiveNote note;
    while (world.queues->notes.pop(note)) {
    }
    world.wire.arrive(stop_frame());
    world.guard->turn(world.wire.now_us);
    ASSERT_TRUE(world.queues->notes.pop(note));
    EXPECT_EQ(note.kind, LiveNote::Kind::wire);
    EXPECT_EQ(note.frame_id, world.machine.can.stop_id);
    EXPECT_STREQ(note.words, "a stop frame from another sender");
    ASSERT_TRUE(world.queues->notes.pop(note));
    EXPECT_EQ(note.kind, LiveNote::Kind::phase);
    EXPECT_STREQ(to_text(note.cause), "foreign_stop");
}

}  // namespace
}  // namespace axg
