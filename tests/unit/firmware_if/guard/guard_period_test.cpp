// SPDX-License-Identifier: Apache-2.0
// What the live guard makes of a board's period, of a bus that delivers late, and of one that
// delivers twice.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/support/live_world.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

class GuardPeriod : public testing::TestWithParam<CanFormat> {
  protected:
    static Machine machine_of(CanFormat format, std::uint32_t sample_us = 1000) {
        Machine machine = test::five_axis_machine(format);
        machine.can.sample_us = sample_us;
        machine.can.stale_after_us = 12 * sample_us;
        machine.can.permit_samples = {3, 12};
        return machine;
    }
    /// The deployed guard, and a board whose period may be another one.
    void start(std::uint32_t board_us) {
        latch = {kLatchClear, ~kLatchClear};
        world.options.ignores_period = false;
        world.start();
        world.machine.can.sample_us = board_us;
    }
    const Guard& guard() const { return world.guard->guard(); }
    LiveNote last_fault() {
        LiveNote note, found;
        while (world.queues->notes.pop(note)) {
            found = note.kind == LiveNote::Kind::input ? note : found;
        }
        return found;
    }

    LatchCell latch{kLatchClear, ~kLatchClear};
    test::LiveWorld world{machine_of(GetParam()), latch};
};

// Before it is shown nothing is ready, and the state says what is missing.
TEST_P(GuardPeriod, ARightOneIsReadyOnceItIsShown) {
    start(1000);
    world.run_periods(100);
    EXPECT_EQ(guard().phase, GuardPhase::selftest);
    EXPECT_EQ(world.guard->withheld().why, WithheldPermit::Why::period);
    world.run_periods(70);
    world.guard->arm(world.wire.now_us);
    world.run_periods(300);
    EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
}

TEST_P(GuardPeriod, AWrongOneIsNeverReadyAndIsNamed) {
    for (const std::uint32_t board_us : {800U, 950U, 985U, 1020U}) {
        world.machine.can.sample_us = 1000;
        start(board_us);
        LiveNote fault;
        for (int i = 0; i < 1200; ++i) {
            world.run_periods(1);
            world.guard->arm(world.wire.now_us);
            ASSERT_NE(guard().phase, GuardPhase::armed) << board_us;
            const LiveNote note = last_fault();
            fault = note.kind == LiveNote::Kind::input ? note : fault;
        }
        EXPECT_EQ(guard().phase, GuardPhase::stopped) << board_us;
        EXPECT_EQ(guard().cause, GuardFault::input);
        EXPECT_EQ(world.guard->counters().permits, 0U);
        EXPECT_STREQ(fault_row(fault.fault).name, "sync_period");
        EXPECT_EQ(fault.ours, 1'000'000U);
        EXPECT_NEAR(static_cast<double>(fault.theirs), 1000.0 * board_us, 1000);
    }
}

// Armed, and then 3 % long: stopped by a long window.
TEST_P(GuardPeriod, OneThatChangesWhileArmedStops) {
    start(1000);
    world.run_periods(200);
    world.guard->arm(world.wire.now_us);
    world.run_periods(100);
    ASSERT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
    std::int64_t later_us = 0;
    world.alters = [&](std::vector<CanFrame>& frames) {
        later_us += 30;
        for (CanFrame& frame : frames) {
            frame.time_us += later_us;
        }
    };
    world.run_periods(600);
    EXPECT_EQ(guard().phase, GuardPhase::stopped);
    EXPECT_STREQ(fault_row(last_fault().fault).name, "sync_period");
}

INSTANTIATE_TEST_SUITE_P(Formats, GuardPeriod,
                         testing::Values(CanFormat::classical, CanFormat::fd, CanFormat::cia402));

/// A healthy board on a bus of which `alters` says what it does.
class GuardBus : public GuardPeriod {
  protected:
    GuardBus() { world.machine.can.sample_us = 2000; }
    /// Armed for 1,000 samples, each of which has its permit.
    void expect_every_permit() {
        start(2000);
        world.run_periods(200);
        ASSERT_EQ(guard().phase, GuardPhase::ready)
            << to_text(guard().phase) << ": " << to_text(guard().cause) << ", "
            << to_text(world.guard->withheld().why);
        world.guard->arm(world.wire.now_us);
        const std::uint64_t samples = world.guard->counters().snapshots;
        world.run_periods(1000);
        EXPECT_EQ(guard().phase, GuardPhase::armed) << to_text(guard().cause);
        EXPECT_EQ(guard().bad, 0U);
        EXPECT_GE(world.guard->counters().permits + 2, world.guard->counters().snapshots - samples);
    }
    bool is_odd = false;
};

TEST_P(GuardBus, EverySecondSampleLateIsAsGoodAsAnyOther) {
    for (const bool is_sync_late : {true, false}) {
        world.alters = [&](std::vector<CanFrame>& frames) {
            is_odd = !is_odd;
            for (CanFrame& frame : frames) {
                const bool is_late = is_odd && (is_sync_late || frame.id != 0x080);
                frame.time_us += is_late ? 1300 : 0;
            }
        };
        expect_every_permit();
    }
}

// At random: a good period takes any delay that leaves the longest evaluation before the next
// sample.
TEST_P(GuardBus, ADelayOfHalfTheSlackCostsNoPermit) {
    world.response_us = world.machine.deadline_us - 200;  // this world steps by 50 us
    std::mt19937_64 random(test::printed_seed(77));
    world.alters = [&](std::vector<CanFrame>& frames) {
        const std::int64_t most_us = (2000 - world.machine.deadline_us) / 2 - 20;
        const auto late_us = static_cast<std::int64_t>(random() % 3) * most_us / 2;
        for (CanFrame& frame : frames) {
            frame.time_us += late_us;
        }
    };
    expect_every_permit();
}

TEST_P(GuardBus, EveryFrameTwiceIsAsGoodAsOnce) {
    world.alters = [](std::vector<CanFrame>& frames) {
        std::vector<CanFrame> twice;
        for (const CanFrame& frame : frames) {
            twice.push_back(frame);
            twice.push_back(frame);
            twice.back().time_us += 20;
        }
        frames = twice;
    };
    expect_every_permit();
    const ReceiverCounters& counters = world.guard->receiver().counters();
    EXPECT_GT(counters.of(ReceiverFault::repeated), 1000U);
}

INSTANTIATE_TEST_SUITE_P(Formats, GuardBus, testing::Values(CanFormat::classical, CanFormat::fd));

}  // namespace
}  // namespace axg
