// SPDX-License-Identifier: Apache-2.0
// The frame of the look-ahead path: byte by byte, and each fault put into a healthy
// board's frames, with the reaction watched.
#include <gtest/gtest.h>

#include <utility>

#include "firmware_if/protocol/wire.hpp"
#include "tests/support/receiver_fixture.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kLookAhead = 20;
constexpr std::size_t kPlace = 2;  // in a sample: SYNC, positions, this one

Machine look_ahead_machine() {
    Machine machine = five_axis_machine(CanFormat::fd);
    machine.can.look_ahead_samples = kLookAhead;
    return machine;
}

PathPoints points_at(const Machine& machine, std::uint64_t k) {
    PathPoints points;
    points.sample = k + kLookAhead;
    points.position = snapshot_at(machine, k + kLookAhead).position;
    points.before = snapshot_at(machine, k + kLookAhead - 1).position;
    return points;
}

std::vector<CanFrame> encoded_sample(AxisEncoder& encoder, const AxisSnapshot& snapshot,
                                     const PathPoints& points) {
    std::vector<CanFrame> frames(kFramesPerSnapshotMax);
    const EncodeResult result = encoder.encode(snapshot, frames, &points);
    EXPECT_EQ(result.status, EncodeStatus::ok);
    frames.resize(result.frame_count);
    return frames;
}

/// A board of 60 samples with a look-ahead path, and a receiver.
struct LookAheadFixture {
    Machine machine = look_ahead_machine();
    Samples samples;
    AxisReceiver receiver{machine};
    Heard heard;
    std::vector<PathPoints> announced;

    LookAheadFixture() {
        AxisEncoder encoder(machine);
        for (std::uint64_t k = 0; k < 60; ++k) {
            samples.push_back(
                encoded_sample(encoder, snapshot_at(machine, k), points_at(machine, k)));
        }
    }
    void hear() {
        for (const auto& sample : samples) {
            for (const CanFrame& frame : sample) {
                const ReceiverEvent event = receiver.on_frame(frame);
                if (event.kind == ReceiverEvent::Kind::look_ahead) {
                    announced.push_back(event.look_ahead);
                } else if (event.kind == ReceiverEvent::Kind::snapshot) {
                    heard.snapshots.push_back(event.snapshot);
                } else if (event.kind == ReceiverEvent::Kind::fault) {
                    heard.faults.push_back(event);
                }
            }
        }
    }
    CanFrame& at(std::size_t sample) { return samples[sample][kPlace]; }
    void seal(CanFrame& frame) const {
        p05_protect({frame.data.data(), frame.length_bytes}, machine.can.look_ahead_data_id,
                    frame.data[2]);
    }
    /// The frames of samples 30 and the fault they came to; everything else was used.
    void expect_dropped(ReceiverFault fault, std::size_t count = 1) {
        hear();
        EXPECT_EQ(receiver.counters().of(fault), count) << fault_row(fault).name;
        EXPECT_EQ(heard.faults.size(), count);
        EXPECT_EQ(announced.size(), samples.size() - count);
        EXPECT_EQ(heard.snapshots.size(), samples.size()) << "positions are not touched by it";
        EXPECT_EQ(receiver.state(), ReceiverState::valid);
    }
};

TEST(LookAheadFrame, ByteByByte) {
    const Machine machine = look_ahead_machine();
    AxisEncoder encoder(machine);
    AxisSnapshot snapshot = snapshot_at(machine, 0);
    snapshot.sample = 6;
    PathPoints points = points_at(machine, 6);
    points.position = {1.5, -0.0001, 0, kPi / 180, -kPi / 2};
    points.before = {0.00005, 0, 300, 0, 4 * kPi + kPi / 2};
    const CanFrame frame = encoded_sample(encoder, snapshot, points)[kPlace];
    EXPECT_EQ(frame.id, 0x481U);
    EXPECT_TRUE(frame.fd && frame.bit_rate_switch);
    EXPECT_EQ(frame.length_bytes, 48);
    EXPECT_EQ(frame.data[3], 7) << "SYNC counter of sample 6";
    EXPECT_EQ(frame.data[4] + 256 * frame.data[5], static_cast<int>(kLookAhead));
    const auto counts = [&](std::size_t place) {
        return detail::sign_extend(detail::get_little(frame.data.data() + 6 + 4 * place, 4), 32);
    };
    const std::array<std::int64_t, 10> wanted{15000, -1, 0,         10'000, 2'700'000,
                                              1,     0,  3'000'000, 0,      900'000};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_EQ(counts(i), wanted[i]) << i;
    }
    EXPECT_EQ(frame.data[46] | frame.data[47], 0);
    EXPECT_TRUE(p05_check({frame.data.data(), 48}, 0x0481));
    LookAheadFrameContent content;
    ASSERT_EQ(decode_look_ahead_frame(encoder.frame_set(), frame, content), FrameStatus::ok);
    EXPECT_EQ(content.sync_counter, 7);
    EXPECT_EQ(content.samples, kLookAhead);
    EXPECT_DOUBLE_EQ(content.position[0], 1.5);
    EXPECT_NEAR(content.before[4], kPi / 2, 1e-12);
}

TEST(LookAheadFrame, WhatWasSentArrivesWithTheSamplesOfTheSnapshots) {
    LookAheadFixture fixture;
    fixture.hear();
    ASSERT_EQ(fixture.announced.size(), 60U);
    EXPECT_TRUE(fixture.heard.faults.empty());
    EXPECT_EQ(fixture.receiver.counters().look_ahead, 60U);
    for (std::uint64_t k = 0; k < 60; ++k) {
        EXPECT_EQ(fixture.announced[k].sample, k + kLookAhead);
        const PathPoints sent = points_at(fixture.machine, k);
        EXPECT_NEAR(fixture.announced[k].position[0], sent.position[0], 0.5001e-4);
        EXPECT_NEAR(fixture.announced[k].before[1], sent.before[1], 0.5001e-4);
        if (k + 1 < 60) {
            EXPECT_EQ(fixture.announced[k].position, fixture.announced[k + 1].before);
        }
    }
}

// Without a snapshot nobody knows which instants are spoken of.
TEST(LookAheadFrame, BeforeTheFirstSnapshotNothingIsTaken) {
    LookAheadFixture fixture;
    std::swap(fixture.samples[0][1], fixture.samples[0][2]);
    fixture.hear();
    EXPECT_EQ(fixture.announced.size(), 59U);
    EXPECT_TRUE(fixture.heard.faults.empty());
}

TEST(LookAheadFrame, LostAndLateFramesLeaveTheirNeighbours) {
    LookAheadFixture fixture;
    fixture.samples[30].erase(fixture.samples[30].begin() + kPlace);
    std::swap(fixture.samples[40][1], fixture.samples[40][2]);  // overtakes its own positions
    fixture.hear();
    EXPECT_EQ(fixture.announced.size(), 59U);
    EXPECT_TRUE(fixture.heard.faults.empty());
    EXPECT_EQ(fixture.announced[30].sample, 31 + kLookAhead);
    EXPECT_EQ(fixture.announced[39].sample, 40 + kLookAhead);
}

// Where positions are lost the look-ahead path goes on: both count by the SYNC counter.
TEST(LookAheadFrame, GoesOnWherePositionsAreLost) {
    LookAheadFixture fixture;
    fixture.samples[30].erase(fixture.samples[30].begin() + 1);
    fixture.hear();
    EXPECT_EQ(fixture.heard.snapshots.size(), 59U);
    ASSERT_EQ(fixture.announced.size(), 60U);
    EXPECT_EQ(fixture.announced[30].sample, 30 + kLookAhead);
}

TEST(LookAheadFrame, AWrongLengthIsDropped) {
    LookAheadFixture fixture;
    fixture.at(30).length_bytes = 32;
    fixture.expect_dropped(ReceiverFault::bad_length);
}

TEST(LookAheadFrame, AClassicalFrameIsDropped) {
    LookAheadFixture fixture;
    fixture.at(30).fd = false;
    fixture.expect_dropped(ReceiverFault::bad_format);
}

TEST(LookAheadFrame, EverySingleBitErrorIsDropped) {
    const LookAheadFixture healthy;
    const AxisFrameSet set = make_frame_set(healthy.machine);
    LookAheadFrameContent content;
    for (std::size_t bit = 0; bit < 48 * 8; ++bit) {
        CanFrame frame = healthy.samples[30][kPlace];
        frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << (bit % 8)));
        EXPECT_EQ(decode_look_ahead_frame(set, frame, content), FrameStatus::bad_crc) << bit;
    }
    LookAheadFixture fixture;
    fixture.at(30).data[20] ^= 1U;
    fixture.expect_dropped(ReceiverFault::bad_crc);
}

// The right payload under another id, and positions under this one.
TEST(LookAheadFrame, TheDataIdTellsItFromOtherFrames) {
    LookAheadFixture fixture;
    CanFrame& frame = fixture.at(30);
    p05_protect({frame.data.data(), frame.length_bytes}, 0x0181, frame.data[2]);
    fixture.expect_dropped(ReceiverFault::bad_crc);
    LookAheadFixture swapped;
    const std::uint8_t length = swapped.at(30).length_bytes;
    swapped.at(30).data = swapped.samples[30][1].data;
    swapped.at(30).length_bytes = length;
    swapped.expect_dropped(ReceiverFault::bad_crc);
}

TEST(LookAheadFrame, AnotherNumberOfSamplesIsDropped) {
    LookAheadFixture fixture;
    fixture.at(30).data[4] = kLookAhead - 1;
    fixture.seal(fixture.at(30));
    fixture.expect_dropped(ReceiverFault::bad_format);
}

TEST(LookAheadFrame, APositionThatIsNotKnownIsDropped) {
    LookAheadFixture fixture;
    detail::put_little(fixture.at(30).data.data() + 6, 0x80000000U, 4);
    fixture.seal(fixture.at(30));
    fixture.expect_dropped(ReceiverFault::bad_format);
}

TEST(LookAheadFrame, PaddingAndTheSyncCounterAreChecked) {
    for (const auto& [place, value] : {std::pair{47, 1}, {3, 0}, {3, 241}}) {
        LookAheadFixture fixture;
        fixture.at(30).data[static_cast<std::size_t>(place)] = static_cast<std::uint8_t>(value);
        fixture.seal(fixture.at(30));
        fixture.expect_dropped(ReceiverFault::bad_format);
    }
}

// A frame that speaks of another sample than the positions around it: two periods late or ten
// early is what queues and lost positions can do.
TEST(LookAheadFrame, AnIndexThatDoesNotFitTheSnapshotsIsDropped) {
    for (const auto& [index, is_used] :
         {std::pair{28, false}, {29, true}, {41, true}, {42, false}}) {
        LookAheadFixture fixture;
        fixture.at(30).data[3] = static_cast<std::uint8_t>(index);  // 31 is its own
        fixture.seal(fixture.at(30));
        if (is_used) {
            fixture.hear();
            EXPECT_TRUE(fixture.heard.faults.empty()) << index;
            EXPECT_EQ(fixture.announced[30].sample,
                      static_cast<std::uint64_t>(index) - 1 + kLookAhead);
        } else {
            fixture.expect_dropped(ReceiverFault::late_sample);
        }
    }
}

TEST(LookAheadFrame, ARepeatedFrameIsDroppedAndASecondSenderStops) {
    LookAheadFixture fixture;
    fixture.samples[30].push_back(fixture.at(30));
    fixture.hear();
    EXPECT_EQ(fixture.receiver.counters().of(ReceiverFault::repeated), 1U);
    EXPECT_EQ(fixture.announced.size(), 60U);

    LookAheadFixture spoofed;
    CanFrame other = spoofed.at(30);
    other.data[6] ^= 1U;
    spoofed.seal(other);
    spoofed.samples[30].push_back(other);
    spoofed.hear();
    EXPECT_EQ(spoofed.receiver.stop_cause(), ReceiverFault::spoofed);
}

TEST(LookAheadFrame, ACounterThatJumpsIsNotUsedUntilItRunsOn) {
    LookAheadFixture fixture;
    for (std::size_t k = 30; k < 60; ++k) {
        fixture.at(k).data[2] = static_cast<std::uint8_t>(fixture.at(k).data[2] + 50);
        fixture.seal(fixture.at(k));
    }
    fixture.expect_dropped(ReceiverFault::wrong_sequence, 2);
}

TEST(LookAheadFrame, MoreThanTwiceTheFramesOfASampleAreAFlood) {
    LookAheadFixture fixture;
    for (int i = 0; i < 2; ++i) {
        fixture.samples[30].push_back(fixture.at(30));
    }
    fixture.hear();
    EXPECT_EQ(fixture.receiver.state(), ReceiverState::valid) << "two sets of two frames";
    LookAheadFixture more;
    for (int i = 0; i < 3; ++i) {
        more.samples[30].push_back(more.at(30));
    }
    more.hear();
    EXPECT_EQ(more.receiver.stop_cause(), ReceiverFault::flood);
}

TEST(LookAheadFrame, ExtendedRemoteAndForeignFramesAreNone) {
    LookAheadFixture fixture;
    CanFrame extended = fixture.at(30), remote = fixture.at(30);
    extended.extended = true;
    remote.remote = true;
    fixture.samples[30].insert(fixture.samples[30].end(), {extended, remote});
    fixture.hear();
    EXPECT_EQ(fixture.receiver.counters().of(ReceiverFault::extended_id), 1U);
    EXPECT_EQ(fixture.receiver.counters().of(ReceiverFault::remote_frame), 1U);
    EXPECT_EQ(fixture.announced.size(), 60U);
    // A machine file without the frame does not know its id.
    Machine silent = fixture.machine;
    silent.can.look_ahead_samples = 0;
    AxisReceiver receiver(silent);
    EXPECT_EQ(receiver.on_frame(fixture.at(30)).kind, ReceiverEvent::Kind::none);
    EXPECT_EQ(receiver.counters().foreign, 1U);
}

// The reader of machine files refuses both: a set must not lead outside its arrays all the same.
TEST(LookAheadLayout, WhatDoesNotFitTheFrameGivesAnEmptySet) {
    Machine machine = look_ahead_machine();
    machine.can.look_ahead_samples = kLookAheadSamplesMax;
    EXPECT_EQ(make_frame_set(machine).axis_count, 5U);
    machine.can.look_ahead_samples = kLookAheadSamplesMax + 1;
    EXPECT_EQ(make_frame_set(machine).axis_count, 0U);
    machine = look_ahead_machine();
    machine.axes.resize(8, machine.axes[0]);
    EXPECT_EQ(make_frame_set(machine).axis_count, 0U);
}

}  // namespace
}  // namespace axg::test
