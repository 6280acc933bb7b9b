// SPDX-License-Identifier: Apache-2.0
// A guard that is the producer of SYNC (can.sync: guard): drives without a counter of their own
// latch on it, and a board dates its permits by it. A second producer, and more jitter than is
// supposed, stop.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_if/protocol/obeyed_by.hpp"
#include "hil_replay/board/permit_watch.hpp"
#include "tests/support/live_world.hpp"

namespace axg {
namespace {

using test::LiveWorld;

/// Each drive sends its speed as well: else nothing shows that it stands.
Machine machine_of_drives() {
    Machine machine = test::five_axis_machine(CanFormat::cia402);
    for (std::uint32_t axis = 1; axis < 5; ++axis) {
        CanSignal speed = machine.can.signals.back();
        speed.id = 0x283 + axis;
        speed.axis = axis;
        machine.can.signals.push_back(speed);
    }
    machine.can.sync_counter_max = 240;
    machine.can.guard_sends_sync = true;
    machine.guard.latch_jitter_s = 300e-6;
    return machine;
}

class GuardSync : public testing::Test {
  protected:
    GuardSync() { set_latch(latch, false); }
    [[nodiscard]] const Guard& guard() const { return world().guard->guard(); }
    LiveWorld& world() const { return *world_; }
    void start(const Machine& machine) { world_ = std::make_unique<LiveWorld>(machine, latch); }
    void run_to_armed() {
        start(machine_of_drives());
        world().says_session = [this](test::SessionSays& says) {
            says.nonce = nonce;
            return true;
        };
        world().run_to_armed();
        ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    }

    std::uint32_t nonce = 0xC0FFEE;
    LatchCell latch;
    std::unique_ptr<LiveWorld> world_;
};

TEST_F(GuardSync, ABoardAcceptsThePermitsOfDrivesWithoutACounterOfTheirOwn) {
    nonce = 0x5EED01;  // of a PermitWatch
    run_to_armed();
    const Machine& machine = world().machine;
    EXPECT_EQ(obeyed_by_refusal(machine), "");
    const std::int64_t armed_us = world().wire.now_us;
    world().run_periods(500);  // the counter wraps twice
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    PermitWatch board(machine.can);
    std::uint64_t syncs = 0, pairs = 0;
    for (CanFrame frame : world().wire.sent) {
        frame.time_us += world().wire.echo_us;
        if (frame.id == machine.can.sync_id) {
            EXPECT_EQ(frame.length_bytes, 1);
            EXPECT_EQ(frame.data[0], 1 + syncs++ % 240);
            board.on_latch(frame.data[0], frame.time_us);
        } else {
            board.on_frame(frame);
            pairs += frame.id == machine.can.permit_id ? 1U : 0U;
            EXPECT_TRUE(frame.id != machine.can.permit_id || frame.data[1] != 0);
        }
    }
    EXPECT_GE(world().count_sent(machine.can.sync_id, armed_us), 499U);
    EXPECT_GT(board.permits(), 490U);
    EXPECT_EQ(board.permits(), pairs - 1);
    EXPECT_EQ(board.refused(), 1U) << "the first pair begins the live counter";
}

TEST_F(GuardSync, ASecondProducerStops) {
    run_to_armed();
    world().wire.arrive(encode_sync(world().machine.can.sync_id, 7, world().wire.now_us + 10));
    world().run_periods(1);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_EQ(guard().cause, GuardFault::second_guard);
}

// Drives go on to latch: how else would the axes be seen to stand?
TEST_F(GuardSync, GoesOnInAStop) {
    run_to_armed();
    world().guard->report(GuardFault::refused, world().wire.now_us);
    const std::int64_t stopped_us = world().wire.now_us;
    world().stands_still = true;
    world().run_periods(LiveWorld::kStandPeriods + 50);
    EXPECT_EQ(world().count_sent(world().machine.can.sync_id, stopped_us),
              static_cast<std::size_t>(LiveWorld::kStandPeriods + 50));
    EXPECT_TRUE(guard().is_confirmed);
}

TEST_F(GuardSync, ASyncThatEndsLaterThanTheJitterStops) {
    for (const std::int64_t echo_us : {300, 350}) {
        run_to_armed();
        world().wire.echo_us = echo_us;
        world().run_periods(20);
        EXPECT_EQ(guard().phase == GuardPhase::armed, echo_us == 300) << to_text(guard().cause);
        if (echo_us != 300) {
            EXPECT_EQ(guard().cause, GuardFault::input);
        }
        set_latch(latch, false);
    }
}

// A late turn leaves its SYNC out. The next one has the number after it, so the sample is lost and
// not mistaken; of drives the one after it is not used either (docs/reference/protocol.md).
TEST_F(GuardSync, ALateTurnLosesItsSample) {
    for (const std::int64_t late_us : {150, 200}) {
        set_latch(latch, false);
        run_to_armed();
        const AxisReceiver& receiver = world().guard->receiver();
        const std::uint64_t before = receiver.counters().samples_lost;
        const std::size_t sent = world().count_sent(world().machine.can.sync_id);
        const std::int64_t due_us = world().wire.now_us + 1000;
        world().run_until(due_us - 500);
        world().is_held = true;
        world().run_until(due_us + late_us);
        world().is_held = false;
        world().run_until(due_us + 20'000);
        EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
        const bool is_sent = late_us == 150;
        EXPECT_EQ(receiver.counters().samples_lost, before + (is_sent ? 0U : 2U));
        EXPECT_EQ(world().count_sent(world().machine.can.sync_id), sent + (is_sent ? 21U : 20U));
    }
}

// Without an echo nothing dates a sample, whatever the drives send.
TEST_F(GuardSync, WithoutItsEchoTheSamplesEnd) {
    run_to_armed();
    const std::uint64_t before = world().guard->counters().snapshots;
    world().wire.is_deaf = true;
    world().run_periods(20);
    EXPECT_LE(world().guard->counters().snapshots, before + 1);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
}

}  // namespace
}  // namespace axg
