// SPDX-License-Identifier: Apache-2.0
// The frames that the guard sends beside the permit, byte by byte.
#include "firmware_if/protocol/guard_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/frame_bytes.hpp"

namespace axg {
namespace {

using test::bytes_of;

const CanLayout kLayout;

TEST(EncodeStop, IsTheBareGlobalCommand) {
    const CanFrame frame = encode_stop(kLayout, 5);
    EXPECT_EQ(frame.id, 0x001U);
    EXPECT_EQ(frame.length_bytes, 0);
    EXPECT_EQ(decode_stop(kLayout, frame), GuardFrameStatus::ok);
    CanFrame longer = frame;
    longer.length_bytes = 1;
    EXPECT_EQ(decode_stop(kLayout, longer), GuardFrameStatus::bad_shape);
    CanFrame remote = frame;
    remote.remote = true;
    EXPECT_EQ(decode_stop(kLayout, remote), GuardFrameStatus::bad_shape);
    CanFrame other = frame;
    other.id = 2;
    EXPECT_EQ(decode_stop(kLayout, other), GuardFrameStatus::not_ours);
}

TEST(EncodeEmergency, IsTheDocumentedBytes) {
    const Emergency emergency{EmergencyCode::contact, 0x81, 3, -2, 0x1234};
    const CanFrame frame = encode_emergency(kLayout, emergency, 5);
    EXPECT_EQ(frame.id, 0x082U);
    EXPECT_EQ(bytes_of(frame),
              (std::vector<std::uint8_t>{0x02, 0xFF, 0x81, 3, 0xFE, 0xFF, 0x34, 0x12}));
    Emergency got;
    EXPECT_EQ(decode_emergency(kLayout, frame, got), GuardFrameStatus::ok);
    EXPECT_EQ(got, emergency);
    CanFrame unknown = frame;
    unknown.data[0] = 7;  // 0xFF07
    EXPECT_EQ(decode_emergency(kLayout, unknown, got), GuardFrameStatus::bad_word);
}

TEST(EncodeEmergency, NumbersAreClampedNotWrapped) {
    EXPECT_EQ(emergency_clearance(1.239), 123);
    EXPECT_EQ(emergency_clearance(-400), -32768);
    EXPECT_EQ(emergency_clearance(400), 32767);
    EXPECT_EQ(emergency_clearance(INFINITY), 0);
    EXPECT_EQ(emergency_time(0.01239), 123);
    EXPECT_EQ(emergency_time(-1), 0);
    EXPECT_EQ(emergency_time(100), 65535);
}

TEST(GuardHeartbeat, KnowsThreeStates) {
    for (const GuardHeartbeat heartbeat :
         {GuardHeartbeat::running, GuardHeartbeat::tripped, GuardHeartbeat::starting}) {
        const CanFrame frame = encode_guard_heartbeat(kLayout, heartbeat, 5);
        EXPECT_EQ(frame.id, 0x702U);
        GuardHeartbeat got{};
        EXPECT_EQ(decode_guard_heartbeat(kLayout, frame, got), GuardFrameStatus::ok);
        EXPECT_EQ(got, heartbeat);
    }
    CanFrame boot = encode_guard_heartbeat(kLayout, GuardHeartbeat::running, 5);
    boot.data[0] = 0;
    GuardHeartbeat got{};
    EXPECT_EQ(decode_guard_heartbeat(kLayout, boot, got), GuardFrameStatus::bad_word);
}

}  // namespace
}  // namespace axg
