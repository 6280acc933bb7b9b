// SPDX-License-Identifier: Apache-2.0
// The frames the guard sends, byte by byte, and every way in which a permit must not be believed.
#include "firmware_if/protocol/guard_frames.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "tests/support/frame_bytes.hpp"

namespace axg {
namespace {

using test::bytes_of;

const CanLayout kLayout;
const Permit kPermit{PermitWord::run, 20, 7, 0xBEEF, 125, 3, 42};

TEST(PermitWord, AnyTwoDifferInFourBitsAndNoneIsZero) {
    const unsigned words[] = {0xA5, 0xC3, 0x5A, 0x3C};
    EXPECT_EQ(static_cast<unsigned>(PermitWord::run), words[0]);
    EXPECT_EQ(static_cast<unsigned>(PermitWord::slow), words[1]);
    EXPECT_EQ(static_cast<unsigned>(PermitWord::stop), words[2]);
    EXPECT_EQ(static_cast<unsigned>(PermitWord::jog), words[3]);
    for (const unsigned a : words) {
        EXPECT_GE(std::popcount(a), 4);
        for (const unsigned b : words) {
            EXPECT_TRUE(a == b || std::popcount(a ^ b) >= 4);
        }
    }
}

TEST(EncodePermit, IsTheDocumentedBytesAndTheirTwin) {
    const auto pair = encode_permit(kLayout, kPermit, 99);
    EXPECT_EQ(pair[0].id, 0x103U);
    EXPECT_EQ(pair[1].id, 0x104U);
    EXPECT_EQ(pair[0].time_us, 99);
    EXPECT_EQ(bytes_of(pair[0]), (std::vector<std::uint8_t>{0xA5, 20, 7, 0xEF, 0xBE, 125, 3, 42}));
    EXPECT_EQ(bytes_of(pair[1]),
              (std::vector<std::uint8_t>{0x5A, 235, 248, 0x10, 0x41, 130, 252, 213}));
}

TEST(EncodePermit, AZeroedPermitIsAStop) {
    EXPECT_EQ(Permit{}.word, PermitWord::stop);
}

TEST(PermitOf, SaysSlowWhereAClearanceLevelIsSlowOrWorseAndNothingWithoutAPermit) {
    CycleResult result;
    result.has_permit = true;
    result.known_answer_signature = 0xBEEF;
    result.advisories.speed_cap = 125;
    EXPECT_EQ(permit_of(result, 7, 20), (Permit{PermitWord::run, 20, 7, 0xBEEF, 125, 255, 0}));
    result.advisories = {125, ClearanceLevel::warn, 3, 4.29};
    EXPECT_EQ(permit_of(result, 7, 20), kPermit) << "a warning is no reason to be slow";
    for (const ClearanceLevel level : {ClearanceLevel::slow, ClearanceLevel::stop}) {
        result.advisories.clearance_level = level;
        EXPECT_EQ(permit_of(result, 7, 20).word, PermitWord::slow);
    }
    result.advisories.pair = 300;
    EXPECT_EQ(permit_of(result, 7, 20).pair, 255);
    result.has_permit = false;
    result.pair = 5;
    EXPECT_EQ(permit_of(result, 7, 20), (Permit{PermitWord::stop, 20, 7, 0xBEEF, 0, 5, 0}));
}

TEST(PermitClearance, IsNeverRoundedUp) {
    EXPECT_EQ(permit_clearance(0.0999), 0);
    EXPECT_EQ(permit_clearance(0.1001), 1);
    EXPECT_EQ(permit_clearance(25.39), 253);
    EXPECT_EQ(permit_clearance(1000), 255);
    EXPECT_EQ(permit_clearance(-1), 0);
    EXPECT_EQ(permit_clearance(std::nan("")), 0);
}

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

/// Feeds one pair; what came of the second frame, or of the first if that was a fault.
PermitChecker::Result feed(PermitChecker& checker, const Permit& permit, std::int64_t time_us) {
    const auto pair = encode_permit(kLayout, permit, time_us);
    const auto first = checker.on_frame(pair[0]);
    return first.fault != PermitFault::none ? first : checker.on_frame(pair[1]);
}

TEST(PermitChecker, TakesGoodPairsThroughTheCountersWrap) {
    PermitChecker checker(kLayout);
    Permit permit = kPermit;
    for (int k = 0; k < 600; ++k) {
        permit.live_counter = static_cast<std::uint8_t>(k);
        const auto result = feed(checker, permit, k * 1000);
        ASSERT_TRUE(result.is_permit) << k << to_text(result.fault);
        EXPECT_EQ(result.permit, permit);
    }
}

TEST(PermitChecker, AbsenceIsAFaultOnBothSidesOfThePeriod) {
    PermitChecker checker(kLayout);
    EXPECT_EQ(checker.on_time(1'000'000).fault, PermitFault::none);  // none was given yet
    ASSERT_TRUE(feed(checker, kPermit, 1000).is_permit);
    EXPECT_EQ(checker.on_time(5000).fault, PermitFault::none);
    EXPECT_EQ(checker.on_time(5001).fault, PermitFault::period);
    EXPECT_EQ(checker.on_time(5002).fault, PermitFault::none);  // said once
}

TEST(PermitChecker, EveryBitOfTheTwinCounts) {
    for (unsigned bit = 0; bit < 64; ++bit) {
        PermitChecker checker(kLayout);
        auto pair = encode_permit(kLayout, kPermit, 0);
        pair[1].data[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        EXPECT_EQ(checker.on_frame(pair[0]).fault, PermitFault::none);
        EXPECT_EQ(checker.on_frame(pair[1]).fault, PermitFault::twin_differs) << bit;
    }
}

TEST(PermitChecker, OrderTimeShapeWordAndCounterCount) {
    const auto pair = encode_permit(kLayout, kPermit, 0);
    {
        PermitChecker checker(kLayout);
        EXPECT_EQ(checker.on_frame(pair[1]).fault, PermitFault::twin_alone);
    }
    {
        PermitChecker checker(kLayout);
        EXPECT_EQ(checker.on_frame(pair[0]).fault, PermitFault::none);
        EXPECT_EQ(checker.on_frame(pair[0]).fault, PermitFault::twin_missing);
    }
    for (const std::int64_t late_us : {2000, 2001}) {
        PermitChecker checker(kLayout);
        auto late = pair;
        late[1].time_us = late_us;
        EXPECT_EQ(checker.on_frame(late[0]).fault, PermitFault::none);
        EXPECT_EQ(checker.on_frame(late[1]).fault,
                  late_us == 2000 ? PermitFault::none : PermitFault::twin_late);
    }
    {
        PermitChecker checker(kLayout);
        auto cut = pair;
        cut[0].length_bytes = 7;
        EXPECT_EQ(checker.on_frame(cut[0]).fault, PermitFault::bad_shape);
    }
    for (const unsigned word : {0x00U, 0xFFU, 0xA4U}) {
        PermitChecker checker(kLayout);
        Permit permit = kPermit;
        permit.word = static_cast<PermitWord>(word);
        EXPECT_EQ(feed(checker, permit, 0).fault, PermitFault::bad_word);
    }
    for (const int echo : {0, 1, 240, 241}) {
        PermitChecker checker(kLayout);
        Permit permit = kPermit;
        permit.sync_counter = static_cast<std::uint8_t>(echo);
        EXPECT_EQ(feed(checker, permit, 0).is_permit, echo >= 1 && echo <= 240);
    }
}

TEST(PermitChecker, TheLiveCounterIsOneToThreeAheadOfTheLast) {
    for (unsigned step = 0; step < 256; ++step) {
        for (const unsigned last : {7U, 254U}) {  // and over the counter's end
            PermitChecker checker(kLayout);
            Permit permit = kPermit;
            permit.live_counter = static_cast<std::uint8_t>(last);
            ASSERT_TRUE(feed(checker, permit, 0).is_permit);
            permit.live_counter = static_cast<std::uint8_t>(last + step);
            const bool is_ahead = step >= 1 && step <= 3;
            EXPECT_EQ(feed(checker, permit, 1000).fault,
                      is_ahead ? PermitFault::none : PermitFault::live_counter)
                << last << " and " << step;
        }
    }
}

TEST(PermitChecker, AProducerThatRepeatsItsLastGoodPairIsRefused) {
    PermitChecker checker(kLayout);
    ASSERT_TRUE(feed(checker, kPermit, 0).is_permit);
    EXPECT_EQ(feed(checker, kPermit, 1000).fault, PermitFault::live_counter);
}

}  // namespace
}  // namespace axg
