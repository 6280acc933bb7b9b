// SPDX-License-Identifier: Apache-2.0
// The process data of drives (format cia402), with each fault of docs/reference/protocol.md put
// into the frames of healthy ones: what belongs to one SYNC is told by time alone, so what may have
// mixed two instants must not be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/sincos.hpp"
#include "firmware_if/protocol/wire.hpp"
#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

// Places in a sample: SYNC, then the PDOs in the order of the signals.
constexpr std::size_t kDriveX = 1, kDriveY = 2, kVelocityX = 6;

Fixture drives(std::uint64_t count = 40) {
    return Fixture(CanFormat::cia402, count);
}

void set_status(CanFrame& frame, std::uint16_t word) {
    detail::put_little(frame.data.data(), word, 2);
}

TEST(DriveReceiver, HealthyDrivesGiveEverySnapshotWithItsInstant) {
    Fixture fixture = drives(600);
    fixture.hear();
    EXPECT_TRUE(fixture.heard.faults.empty()) << fault_row(fixture.heard.faults.front().fault).name;
    ASSERT_EQ(fixture.heard.snapshots.size(), 600U);
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid) << "without any heartbeat";
    for (std::size_t k = 1; k < 600; ++k) {
        const AxisSnapshot& got = fixture.heard.snapshots[k];
        const AxisSnapshot sent = snapshot_at(fixture.machine, k);
        EXPECT_EQ(got.sample, k);
        EXPECT_EQ(got.latched_us, sent.latched_us) << "the end of SYNC, and not of the last frame";
        EXPECT_GT(got.arrived_us, sent.latched_us);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(got.position[i], sent.position[i], 0.51 * 5 / 65536);
        }
        const double off = got.position[4] - sent.position[4];
        EXPECT_NEAR(off - 2 * kPi * std::round(off / (2 * kPi)), 0, 4e-6);
    }
}

TEST(DriveReceiver, AVelocityAboveTenCountsInTheFrozenTimeSaysMoving) {
    Fixture fixture = drives();
    // 10 counts in 100 samples of 1 ms are 7.6 mm/s of X: object 0x606C in um/s.
    const double bound = 10 * (5.0 / 65536) / 0.1 * 1000;
    for (const bool is_above : {false, true}) {
        Fixture one = drives();
        for (auto& sample : one.samples) {
            const auto raw = static_cast<std::int64_t>(bound) + (is_above ? 1 : 0);
            detail::put_little(sample[kVelocityX].data.data(), static_cast<std::uint64_t>(-raw), 4);
        }
        one.hear();
        ASSERT_EQ(one.heard.snapshots.size(), 40U);
        EXPECT_EQ(one.heard.snapshots[30].mode, is_above ? kModeMoving : kModeStandstill);
    }
}

TEST(DriveReceiver, PositionsFrozenUnderAVelocityStop) {
    Fixture fixture = drives(140);
    for (std::size_t k = 20; k < fixture.samples.size(); ++k) {
        for (std::size_t i = kDriveX; i < kVelocityX; ++i) {
            fixture.samples[k][i].data = fixture.samples[20][i].data;
        }
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::frozen);
}

TEST(DriveReceiver, ALostSyncLosesItsSampleAndTheNext) {
    Fixture fixture = drives();
    fixture.samples[20].erase(fixture.samples[20].begin() + kSync);
    fixture.hear();
    fixture.expect_running_without(2);
    EXPECT_EQ(fixture.count(ReceiverFault::late_sample), 7U)
        << "each frame by the window, and the last one of the sample after it";
    EXPECT_EQ(fixture.heard.snapshots[20].sample, 22U);
}

TEST(DriveReceiver, ALostFrameLosesItsSampleAndTheNext) {
    Fixture fixture = drives();
    fixture.samples[20].erase(fixture.samples[20].begin() + kDriveY);
    fixture.hear();
    fixture.expect_running_without(2);
    EXPECT_EQ(fixture.count(ReceiverFault::torn), 1U);
    EXPECT_EQ(fixture.receiver.counters().samples_lost, 2U);
}

// The trap: Y of sample 20 comes after SYNC 21, where it looks like Y of sample 21.
TEST(DriveReceiver, AFrameThatComesAfterTheNextSyncIsInNoSnapshot) {
    Fixture fixture = drives();
    CanFrame late = fixture.samples[20][kDriveY];
    fixture.samples[20].erase(fixture.samples[20].begin() + kDriveY);
    late.time_us = fixture.samples[21][kSync].time_us + 1;
    fixture.samples[21].insert(fixture.samples[21].begin() + kDriveX, late);
    fixture.hear();
    fixture.expect_running_without(2);
    for (const AxisSnapshot& snapshot : fixture.heard.snapshots) {
        const AxisSnapshot sent = snapshot_at(fixture.machine, snapshot.sample);
        EXPECT_NEAR(snapshot.position[1], sent.position[1], 1e-4) << snapshot.sample;
    }
    EXPECT_EQ(fixture.count(ReceiverFault::late_sample), 2U) << "the second Y, and the last frame";
}

TEST(DriveReceiver, TheWindowIsKeptOnBothSides) {
    for (const std::int64_t more_us : {0, 1}) {
        Machine machine = five_axis_machine(CanFormat::cia402);
        machine.can.sync_window_us = 800;
        Samples samples = board_frames(machine, 40);
        samples[20].back().time_us = samples[20][kSync].time_us + 800 + more_us;
        AxisReceiver receiver(machine);
        Heard heard;
        for (const auto& sample : samples) {
            listen(receiver, sample, heard);
        }
        EXPECT_EQ(heard.snapshots.size(), more_us == 0 ? 40U : 38U);
        EXPECT_EQ(receiver.counters().of(ReceiverFault::late_sample), more_us == 0 ? 0U : 2U);
    }
}

TEST(DriveReceiver, OnlyTheExactLengthIsUsed) {
    for (const int more : {-1, 1}) {
        Fixture fixture = drives();
        fixture.samples[20][kDriveX].length_bytes = static_cast<std::uint8_t>(6 + more);
        fixture.hear();
        fixture.expect_running_without(2);
        EXPECT_EQ(fixture.count(ReceiverFault::bad_length), 1U);
    }
    Fixture fixture = drives();
    fixture.samples[20][kSync].length_bytes = 1;
    fixture.hear();
    EXPECT_EQ(fixture.count(ReceiverFault::bad_length), 1U) << "a SYNC with a counter";
    EXPECT_EQ(fixture.heard.snapshots.size(), 38U);
}

TEST(DriveReceiver, ADriveInFaultStopsAndOneThatIsOnlyOffDoesNot) {
    struct Case {
        std::uint16_t word;
        bool stops;
    };
    for (const Case& c : {Case{0x0008, true}, Case{0x0218, true}, Case{0x000F, true},
                          Case{0x0237, false}, Case{0x0231, false}, Case{0x0250, false},
                          Case{0x0000, false}, Case{0x0007, false}, Case{0x0048, false}}) {
        Fixture fixture = drives();
        for (std::size_t k = 20; k < 40; ++k) {
            set_status(fixture.samples[k][kDriveY], c.word);
        }
        fixture.hear();
        if (c.stops) {
            fixture.expect_stop(ReceiverFault::drive_fault);
            EXPECT_EQ(fixture.heard.faults.back().axis, 1U);
            EXPECT_EQ(fixture.heard.faults.back().frame_id, 0x184U);
        } else {
            EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid) << c.word;
        }
    }
}

TEST(DriveReceiver, ADriveThatIsNotHomedStops) {
    Fixture fixture = drives();
    set_status(fixture.samples[20][kDriveX], 0x0237);  // bit 8 is homed: cleared
    fixture.hear();
    fixture.expect_stop(ReceiverFault::not_homed);
}

TEST(DriveReceiver, TwoFramesOfOneIdAfterOneSync) {
    Fixture same = drives();
    CanFrame again = same.samples[20][kDriveX];
    same.samples[20].insert(same.samples[20].begin() + kDriveY, again);
    same.hear();
    same.expect_running_without(0);
    EXPECT_EQ(same.count(ReceiverFault::repeated), 1U);

    Fixture other = drives();
    again.data[2] ^= 1U;  // a drive that sends by event, or a second sender
    other.samples[20].insert(other.samples[20].begin() + kDriveY, again);
    other.hear();
    other.expect_stop(ReceiverFault::spoofed);
}

TEST(DriveReceiver, ASecondSyncProducerIsNoSample) {
    Fixture fixture = drives();
    CanFrame extra = fixture.samples[20][kSync];
    extra.time_us += 400;
    fixture.samples[20].insert(fixture.samples[20].begin() + kDriveY, extra);
    std::stable_sort(fixture.samples[20].begin(), fixture.samples[20].end(),
                     [](const CanFrame& a, const CanFrame& b) { return a.time_us < b.time_us; });
    fixture.hear();
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
    EXPECT_EQ(fixture.count(ReceiverFault::sync_early_or_late), 1U);
    EXPECT_GE(fixture.count(ReceiverFault::sync_missing), 1U);
    EXPECT_EQ(fixture.heard.snapshots.size(), 38U) << "what it may have touched, and the next";
}

TEST(DriveReceiver, ASyncHeldUpInAQueueDoesNotMakeItsSampleYounger) {
    Fixture fixture = drives();
    for (CanFrame& frame : fixture.samples[20]) {
        frame.time_us += 300;
    }
    fixture.hear();
    ASSERT_EQ(fixture.heard.snapshots.size(), 40U);
    const std::int64_t late_us =
        fixture.heard.snapshots[20].latched_us - snapshot_at(fixture.machine, 20).latched_us;
    EXPECT_EQ(late_us, 200) << "a fifth of the period, and no more";
    EXPECT_EQ(fixture.count(ReceiverFault::sync_early_or_late), 2U);
}

TEST(DriveReceiver, SilenceIsFoundByTheClock) {
    Fixture fixture = drives();
    fixture.samples.resize(20);
    fixture.hear();
    const std::int64_t last_us = snapshot_at(fixture.machine, 19).latched_us;
    EXPECT_EQ(fixture.receiver.on_time(last_us + 4000).kind, ReceiverEvent::Kind::none);
    EXPECT_EQ(fixture.receiver.on_time(last_us + 4001).fault, ReceiverFault::stale);
}

TEST(DriveReceiver, ACountingSyncTellsHowManyWereLost) {
    Machine machine = five_axis_machine(CanFormat::cia402);
    machine.can.sync_counter_max = 10;
    machine.can.stale_after_us = 5000;
    Samples samples = board_frames(machine, 40);
    samples[20].clear();
    samples[21].clear();
    AxisReceiver receiver(machine);
    Heard heard;
    for (const auto& sample : samples) {
        listen(receiver, sample, heard);
    }
    ASSERT_EQ(heard.snapshots.size(), 37U);
    EXPECT_EQ(heard.snapshots[20].sample, 23U);
    EXPECT_EQ(receiver.counters().samples_lost, 3U) << "with the one after";

    AxisReceiver other(machine);
    samples = board_frames(machine, 40);
    samples[20][kSync].data[0] = 11;
    samples[25][kSync].data[0] = samples[24][kSync].data[0];
    Heard again;
    for (const auto& sample : samples) {
        listen(other, sample, again);
    }
    EXPECT_EQ(other.counters().of(ReceiverFault::bad_format), 1U);
    EXPECT_EQ(other.counters().of(ReceiverFault::repeated), 1U);
    EXPECT_EQ(again.snapshots.size(), 36U) << "each with the sample after it";
}

TEST(DriveReceiver, TheCounterOfAnEndlessAxisWrapsAtTheEndOfItsThirtyTwoBits) {
    Fixture fixture = drives();
    for (std::size_t k = 0; k < fixture.samples.size(); ++k) {
        // Half a count range further on: 2^32 counts are 4096 whole turns.
        CanFrame& frame = fixture.samples[k][5];
        const auto raw = static_cast<std::uint32_t>(detail::get_little(&frame.data[2], 4));
        detail::put_little(&frame.data[2], raw + 0x7FFFFF00U, 4);
    }
    fixture.hear();
    ASSERT_EQ(fixture.heard.snapshots.size(), 40U);
    EXPECT_TRUE(fixture.heard.faults.empty());
    for (std::size_t k = 1; k < 40; ++k) {
        double step =
            fixture.heard.snapshots[k].position[4] - fixture.heard.snapshots[k - 1].position[4];
        step -= 2 * kPi * std::round(step / (2 * kPi));
        EXPECT_NEAR(step, 0.005, 1e-5);
    }
}

TEST(DriveReceiver, AfterAnAcknowledgeItBeginsAnew) {
    Fixture fixture = drives();
    set_status(fixture.samples[10][kDriveY], 0x0008);
    for (std::size_t k = 0; k < 40; ++k) {
        listen(fixture.receiver, fixture.samples[k], fixture.heard);
        if (k == 15) {
            EXPECT_EQ(fixture.receiver.state(), ReceiverState::invalid);
            fixture.receiver.acknowledge();
        }
    }
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
    EXPECT_EQ(fixture.heard.snapshots.size(), 34U);
}

}  // namespace
}  // namespace axg
