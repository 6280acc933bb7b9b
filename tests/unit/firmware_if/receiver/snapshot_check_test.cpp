// SPDX-License-Identifier: Apache-2.0
// Good frames with data that cannot be true: travel, speed, standstill, references, instants. Names
// start with the row of the fault list.
#include "firmware_if/receiver/snapshot_check.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/receiver_fixture.hpp"

namespace axg {
namespace {

using namespace test;

TEST(SnapshotCheck, A01_TheNoPositionMarkerStops) {
    Fixture fixture;
    CanFrame& frame = fixture.samples[20][kFirst];
    frame.data[5] = 0x00;
    frame.data[6] = 0x00;
    frame.data[7] = 0x80;
    seal(frame, 0x0181);
    fixture.hear();
    fixture.expect_stop(ReceiverFault::no_position);
    EXPECT_EQ(fixture.heard.faults.back().axis, 1U);

    Fixture flexible(CanFormat::fd);
    CanFrame& fd = flexible.samples[20][kFirst];
    std::memcpy(fd.data.data() + 4, "\x00\x00\x00\x80", 4);
    p05_protect({fd.data.data(), fd.length_bytes}, 0x0181, fd.data[2]);
    flexible.hear();
    flexible.expect_stop(ReceiverFault::no_position);
}

TEST(SnapshotCheck, A02_OutOfTravelStopsOnBothSidesOfTheBound) {
    for (const double sign : {-1.0, 1.0}) {
        for (const double beyond_mm : {0.0, 0.001}) {
            Fixture fixture;
            AxisEncoder encoder(fixture.machine);
            for (std::size_t k = 0; k < fixture.samples.size(); ++k) {
                AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
                snapshot.position[2] = sign * (250 - 0.1 * std::abs(20.0 - static_cast<double>(k)));
                snapshot.position[2] += k == 20 ? sign * beyond_mm : 0;
                fixture.samples[k] = frames_of(encoder, snapshot);
            }
            fixture.hear();
            if (beyond_mm == 0) {
                fixture.expect_running_without(0);
                EXPECT_EQ(fixture.heard.snapshots[20].position[2], sign * 250);
            } else {
                fixture.expect_stop(ReceiverFault::out_of_travel);
                EXPECT_EQ(fixture.heard.faults.back().axis, 2U);
            }
        }
    }
}

TEST(SnapshotCheck, A03_AJumpBeyondTheAxisSpeedStopsOnBothSidesOfTheBound) {
    // 500 mm/s for 1 ms and 20 us of jitter, 5000 mm/s2 gained, one count of rounding: 0.516 mm
    for (const double step_mm : {0.515, 0.518}) {
        Fixture fixture(CanFormat::classical, 22);
        AxisEncoder encoder(fixture.machine);
        for (std::size_t k = 0; k < 22; ++k) {
            AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
            snapshot.mode = kModeStandstill;
            snapshot.position = {k < 20 ? 0.0 : step_mm, 0, 0, 0, 0};
            fixture.samples[k] = frames_of(encoder, snapshot);
        }
        fixture.hear();
        if (step_mm < 0.516) {
            fixture.expect_running_without(0);
        } else {
            fixture.expect_stop(ReceiverFault::jump);
            EXPECT_EQ(fixture.heard.faults.back().axis, 0U);
        }
    }
}

// A value of this SYNC behind one of the SYNC before: two periods of motion, and 1 % of one.
TEST(SnapshotCheck, A03_PositionsOfDifferentAgesAreNoJump) {
    for (const double step_mm : {1.020, 1.023}) {
        Fixture fixture(CanFormat::classical, 22);
        fixture.machine.can.latched_age = {0, 1000};
        fixture.receiver = AxisReceiver(fixture.machine);
        AxisEncoder encoder(fixture.machine);
        for (std::size_t k = 0; k < 22; ++k) {
            AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
            snapshot.mode = kModeStandstill;
            snapshot.position = {k < 20 ? 0.0 : step_mm, 0, 0, 0, 0};
            fixture.samples[k] = frames_of(encoder, snapshot);
        }
        fixture.hear();
        if (step_mm < 1.021) {
            fixture.expect_running_without(0);
        } else {
            fixture.expect_stop(ReceiverFault::jump);
        }
    }
}

// An encoder may be off by as much as the machine file says: that is no jump, and not beyond the
// travel. What is farther is.
TEST(SnapshotCheck, TheErrorOfAnEncoderIsNoJumpAndNotBeyondTheTravel) {
    struct Case {
        double x_off, z_off;
        ReceiverFault wanted;
    };
    for (const Case& c :
         {Case{0.1, 0.099, ReceiverFault::none}, Case{0.105, 0.099, ReceiverFault::jump},
          Case{0.1, 0.105, ReceiverFault::out_of_travel}}) {
        Machine machine = five_axis_machine(CanFormat::classical);
        machine.axes[0].speed_max = 20;
        machine.axes[0].acceleration_max = 300;
        machine.axes[0].position_error = machine.axes[2].position_error = 0.1;
        AxisReceiver receiver(machine);
        AxisEncoder encoder(machine);
        Heard heard;
        for (std::uint64_t k = 0; k < 40; ++k) {
            const double sign = k % 2 == 0 ? 1 : -1;
            AxisSnapshot snapshot = snapshot_at(machine, k);
            snapshot.position = {0.02 * static_cast<double>(k) + sign * c.x_off, 0,
                                 250 + sign * c.z_off, 0, 0};
            listen(receiver, frames_of(encoder, snapshot), heard);
        }
        EXPECT_EQ(heard.faults.empty() ? ReceiverFault::none : heard.faults.front().fault,
                  c.wanted);
    }
}

TEST(SnapshotCheck, A03_AfterALostSampleTheAxisMayHaveGoneTwiceAsFar) {
    Fixture fixture(CanFormat::classical, 22);
    AxisEncoder encoder(fixture.machine);
    for (std::size_t k = 0; k < 22; ++k) {
        AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
        snapshot.position = {k < 20 ? 0.0 : 1.0, 0.001 * static_cast<double>(k), 0, 0, 0};
        fixture.samples[k] = frames_of(encoder, snapshot);
    }
    fixture.samples[19].clear();
    fixture.hear();
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid);
}

TEST(SnapshotCheck, A04_FrozenPositionsWhileMovingStopAfterExactlyTheLimit) {
    for (const std::uint8_t mode : {kModeMoving, kModeStandstill}) {
        for (const std::size_t count : {100U, 101U}) {  // 99 and 100 repetitions
            Fixture fixture(CanFormat::classical, count);
            AxisEncoder encoder(fixture.machine);
            for (std::size_t k = 0; k < count; ++k) {
                AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
                snapshot.mode = mode;
                snapshot.position = {1, 2, 3, 0.1, 0.2};
                fixture.samples[k] = frames_of(encoder, snapshot);
            }
            fixture.hear();
            if (mode == kModeMoving && count == 101) {
                fixture.expect_stop(ReceiverFault::frozen);
            } else {
                fixture.expect_running_without(0);
            }
        }
    }
}

// The limit is in samples: one that was lost has passed all the same.
TEST(SnapshotCheck, A04_LostSamplesCountAsFrozenToo) {
    for (const std::size_t count : {100U, 101U}) {
        Fixture fixture(CanFormat::classical, count);
        AxisEncoder encoder(fixture.machine);
        for (std::size_t k = 0; k < count; ++k) {
            AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
            snapshot.position = {1, 2, 3, 0.1, 0.2};
            fixture.samples[k] = frames_of(encoder, snapshot);
        }
        fixture.samples[31].clear();
        fixture.samples[62].clear();
        fixture.hear();
        if (count == 101) {
            fixture.expect_stop(ReceiverFault::frozen);
        } else {
            fixture.expect_running_without(2);
        }
    }
}

TEST(SnapshotCheck, A05_FreshFramesFromASenderWhoseClockStandsAreDropped) {
    Fixture fixture(CanFormat::fd);
    for (std::size_t k = 20; k < 40; ++k) {
        CanFrame& frame = fixture.samples[k][kFirst];
        std::memcpy(frame.data.data() + 24, fixture.samples[19][kFirst].data.data() + 24, 4);
        p05_protect({frame.data.data(), frame.length_bytes}, 0x0181, frame.data[2]);
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_EQ(fixture.count(ReceiverFault::sender_clock), 2U);
    EXPECT_EQ(fixture.heard.snapshots.size(), 20U);
}

TEST(SnapshotCheck, A06_MixedInstantsAreNeverOneSnapshot) {
    Fixture fixture;
    for (std::size_t k = 20; k < 40; ++k) {  // frame 3 is one sample behind from here on
        for (std::size_t i = kFirst; i <= kSecond; ++i) {
            CanFrame& frame = fixture.samples[k][i];
            frame.data[1] = static_cast<std::uint8_t>((frame.data[1] & 15U) | ((k + 1) << 4U));
            seal(frame, static_cast<std::uint16_t>(0x81U + 0x100U * i));
        }
    }
    fixture.hear();
    fixture.expect_stop(ReceiverFault::stale);
    EXPECT_EQ(fixture.heard.snapshots.size(), 20U);
}

TEST(SnapshotCheck, A08_ABoardWithoutReferenceStops) {
    Fixture fixture;
    replace_sample_20(fixture, [](AxisSnapshot& snapshot) { snapshot.flags = kFlagNotHomed; });
    fixture.hear();
    fixture.expect_stop(ReceiverFault::not_homed);
}

TEST(SnapshotCheck, A09_AnEndlessAxisTurnsThroughZero) {
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd, CanFormat::signals}) {
        Fixture fixture(format, 60);
        AxisEncoder encoder(fixture.machine);
        for (std::size_t k = 0; k < 60; ++k) {
            AxisSnapshot snapshot = snapshot_at(fixture.machine, k);
            snapshot.position[4] = 0.005 * (30.0 - static_cast<double>(k));
            fixture.samples[k] = frames_of(encoder, snapshot);
        }
        fixture.hear();
        EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid)
            << fault_row(fixture.receiver.stop_cause()).name;
        ASSERT_EQ(fixture.heard.snapshots.size(), 60U);
        EXPECT_NEAR(fixture.heard.snapshots[31].position[4], 2 * kPi - 0.005, 2e-6);
    }
}

}  // namespace
}  // namespace axg
