// SPDX-License-Identifier: Apache-2.0
// Checksums against the published check values, the P05 header against AUTOSAR's vector, and the
// counter rule at every bound, the wrap included: an open implementation is known to get each of
// these wrong.
#include "firmware_if/protocol/e2e.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace axg {
namespace {

const std::array<std::uint8_t, 9> kCheck{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

TEST(Crc, CheckValuesAreThePublishedOnes) {
    EXPECT_EQ(crc8_j1850(kCheck), 0x4B);
    EXPECT_EQ(crc8_h2f(kCheck), 0xDF);
    EXPECT_EQ(crc16_ccitt(kCheck), 0x29B1);
}

TEST(Crc, SixteenBitsMayBeFedInPieces) {
    const std::span<const std::uint8_t> all(kCheck);
    for (std::size_t cut = 0; cut <= all.size(); ++cut) {
        EXPECT_EQ(crc16_ccitt(all.subspan(cut), crc16_ccitt(all.first(cut))), 0x29B1);
    }
}

TEST(ClassicalCrc, IsTheCrcOverSevenBytesAndTheDataIdLowByteFirst) {
    const std::array<std::uint8_t, 8> frame{0xEE, 1, 2, 3, 4, 5, 6, 7};
    const std::array<std::uint8_t, 9> message{1, 2, 3, 4, 5, 6, 7, 0x81, 0x02};
    EXPECT_EQ(classical_crc(frame, 0x0281), crc8_h2f(message));
    EXPECT_NE(classical_crc(frame, 0x8102), crc8_h2f(message));
}

TEST(P05, MatchesTheAutosarVectorLittleEndian) {
    std::array<std::uint8_t, 8> frame{};
    p05_protect(frame, 0x1234, 0);
    const std::array<std::uint8_t, 8> wanted{0x1C, 0xCA, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(frame, wanted);
    EXPECT_TRUE(p05_check(frame, 0x1234));
    EXPECT_FALSE(p05_check(frame, 0x1235));
    EXPECT_FALSE(p05_check(frame, 0x3412));
}

TEST(P05, EveryBitAndEveryCounterIsGuarded) {
    std::array<std::uint8_t, 32> frame{};
    for (std::size_t i = 3; i < frame.size(); ++i) {
        frame[i] = static_cast<std::uint8_t>(17 * i);
    }
    p05_protect(frame, 0x0181, 255);
    for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
        frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        EXPECT_FALSE(p05_check(frame, 0x0181)) << "bit " << bit;
        frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    EXPECT_TRUE(p05_check(frame, 0x0181));
}

TEST(P05, AFrameShorterThanItsHeaderIsRefused) {
    const std::array<std::uint8_t, 3> frame{};
    EXPECT_FALSE(p05_check(std::span(frame).first(0), 0));
    EXPECT_FALSE(p05_check(std::span(frame).first(2), 0));
}

TEST(SequenceCheck, WrapsAreOneStep) {
    for (const int size : {16, 240, 256}) {
        const auto modulus = static_cast<std::uint16_t>(size);
        SequenceCheck check(modulus, 3, 2);
        EXPECT_EQ(check.next(static_cast<std::uint16_t>(modulus - 1)), Sequence::ok);
        EXPECT_EQ(check.next(0), Sequence::ok) << modulus;
        SequenceCheck skipped(modulus, 3, 2);
        EXPECT_EQ(skipped.next(static_cast<std::uint16_t>(modulus - 2)), Sequence::ok);
        EXPECT_EQ(skipped.next(0), Sequence::some_lost) << modulus;
    }
}

TEST(SequenceCheck, EveryStepIsJudgedByTheBound) {
    for (unsigned step = 0; step < 256; ++step) {
        SequenceCheck check(256, 3, 2);
        ASSERT_EQ(check.next(200), Sequence::ok);
        const Sequence wanted = step == 0   ? Sequence::repeated
                                : step == 1 ? Sequence::ok
                                : step <= 3 ? Sequence::some_lost
                                            : Sequence::wrong;
        EXPECT_EQ(check.next(static_cast<std::uint16_t>((200 + step) % 256)), wanted) << step;
    }
}

TEST(SequenceCheck, AWrongFrameDoesNotMoveTheReference) {
    SequenceCheck check(256, 3, 2);
    EXPECT_EQ(check.next(10), Sequence::ok);
    EXPECT_EQ(check.next(100), Sequence::wrong);
    EXPECT_EQ(check.next(11), Sequence::ok);
    EXPECT_EQ(check.next(101),
              Sequence::wrong);  // the good frame broke the order of the wrong ones
    EXPECT_EQ(check.next(12), Sequence::ok);
}

TEST(SequenceCheck, IsBelievedAgainAfterExactlyInitCountGoodFrames) {
    SequenceCheck check(256, 3, 2);
    EXPECT_EQ(check.next(10), Sequence::ok);
    EXPECT_EQ(check.next(100), Sequence::wrong);
    EXPECT_EQ(check.next(101), Sequence::wrong);  // first good one
    EXPECT_EQ(check.next(102), Sequence::ok);     // second
    EXPECT_EQ(check.next(103), Sequence::ok);
    EXPECT_EQ(check.next(10), Sequence::wrong);
}

TEST(SequenceCheck, ABrokenRunStartsAgain) {
    SequenceCheck check(256, 3, 2);
    EXPECT_EQ(check.next(10), Sequence::ok);
    EXPECT_EQ(check.next(100), Sequence::wrong);
    EXPECT_EQ(check.next(101), Sequence::wrong);
    EXPECT_EQ(check.next(50), Sequence::wrong);
    EXPECT_EQ(check.next(51), Sequence::wrong);
    EXPECT_EQ(check.next(52), Sequence::ok);
}

TEST(SequenceCheck, ResetForgets) {
    SequenceCheck check(16, 3, 2);
    EXPECT_EQ(check.next(3), Sequence::ok);
    EXPECT_TRUE(check.is_repeat(3));
    check.reset();
    EXPECT_FALSE(check.is_repeat(3));
    EXPECT_EQ(check.next(12), Sequence::ok);
}

}  // namespace
}  // namespace axg
