// SPDX-License-Identifier: Apache-2.0
// A row of the format table is true of the frames that its codec makes: the one example machine of
// each format, encoded and decoded.
#include "core/machine/wire_format.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/guard/standstill.hpp"
#include "tests/support/can_board.hpp"

namespace axg {
namespace {

TEST(WireFormat, SyncComesFirstAndAHeartbeatLastWhereTheRowHasThem) {
    for (const WireFormat& wire : kWireFormats) {
        const Machine machine = test::five_axis_machine(wire.format);
        const auto frames = test::board_frames(machine, 1).front();
        const AxisFrameSet set = make_frame_set(machine);
        EXPECT_EQ(frames.front().id == machine.can.sync_id, has_sync(wire)) << wire.name;
        const auto heartbeats = std::count_if(
            frames.begin(), frames.end(),
            [&](const CanFrame& frame) { return frame.id == machine.can.heartbeat_in_id; });
        EXPECT_EQ(heartbeats, is_native(wire) ? 1 : 0) << wire.name;
        EXPECT_EQ(own_axis_frames(wire, 5), is_native(wire) ? set.frame_count : 0) << wire.name;
    }
}

TEST(WireFormat, OwnFramesStateTheIndexOfTheirSample) {
    for (const WireFormat& wire : kWireFormats) {
        const Machine machine = test::five_axis_machine(wire.format);
        const AxisFrameSet set = make_frame_set(machine);
        const auto samples = test::board_frames(machine, is_native(wire) ? 500 : 0);
        for (std::size_t k = 0; k < samples.size(); ++k) {
            AxisFrameContent content;
            ASSERT_EQ(decode_axis_frame(set, 0, samples[k][1], content), FrameStatus::ok);
            ASSERT_EQ(content.sample_index, (sync_counter_of(k) - 1) % wire.index_modulus)
                << wire.name << ", sample " << k;
            ASSERT_EQ(content.sender_time_us != 0, wire.has_sender_clock) << wire.name;
        }
    }
}

TEST(WireFormat, OneCountOfAnOwnFrameIsTheUnitOfItsAxes) {
    EXPECT_EQ(axis_units(test::five_axis_machine(CanFormat::classical))[0], 1.0e-3);
    EXPECT_EQ(axis_units(test::five_axis_machine(CanFormat::fd))[0], 1.0e-4);
}

/// A frame for the axes of each count and one for the status: two slots a classical frame.
TEST(WireFormat, ClassicalFramesHaveTwoSlotsAndOneFdFrameHasAll) {
    for (std::uint32_t axes = 1; axes <= kAxesMax; ++axes) {
        EXPECT_EQ(own_axis_frames(wire_format(CanFormat::classical), axes), (axes + 2) / 2);
        EXPECT_EQ(own_axis_frames(wire_format(CanFormat::fd), axes), 1U);
    }
}

TEST(WireFormat, OnlyInstantsByArrivalHaveItsJitter) {
    for (const WireFormat& wire : kWireFormats) {
        CanLayout can;
        can.format = wire.format;
        EXPECT_EQ(arrival_jitter_us_of(can), has_sync(wire) ? 0 : 2 * can.sample_us) << wire.name;
        can.arrival_jitter_us = 7;
        EXPECT_EQ(arrival_jitter_us_of(can), has_sync(wire) ? 0U : 7U) << wire.name;
    }
}

/// Neither machine has a signal that reports motion of all axes.
TEST(WireFormat, DrivesWithoutSpeedsNeverRestAndSignalsRestByPositions) {
    for (const WireFormat& wire : kWireFormats) {
        const Machine machine = test::five_axis_machine(wire.format);
        const StandstillRules rules = standstill_rules(machine, axis_units(machine));
        EXPECT_EQ(rules.is_reported, wire.rest == RestReport::mode) << wire.name;
        EXPECT_EQ(rules.window_samples == kNeverStands, wire.rest == RestReport::speeds)
            << wire.name;
    }
}

TEST(WireFormat, AValueThatIsNoFormatIsTheFirstRow) {
    EXPECT_EQ(&wire_format(static_cast<CanFormat>(4)), &kWireFormats[0]);
}

}  // namespace
}  // namespace axg
