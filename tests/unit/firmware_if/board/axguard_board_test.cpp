// SPDX-License-Identifier: Apache-2.0
// The rules of docs/reference/board.md on the library for firmware, each on both sides of its
// bound; every refusal by its name. The scripts of tests/vectors/permit2.json have the same and
// more, for boards that are written in other languages.
#include "firmware_if/board/axguard_board.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/board_fixture.hpp"

namespace axg {
namespace {

using test::board_pair;
using test::BoardFixture;
using test::BoardPermit;

class AxguardBoard : public ::testing::Test, public BoardFixture {
  protected:
    /// What the last pair was refused for, and that it is counted once more under this name.
    axg_board_refusal refusal_of(const BoardPermit& permit, std::uint64_t at_us) {
        std::uint32_t before[AXG_BOARD_REFUSALS];
        std::memcpy(before, board.refused, sizeof before);
        if (hear(permit, at_us) != AXG_BOARD_HEARD_REFUSED) {
            return AXG_BOARD_REFUSED_NOTHING;
        }
        for (int i = 0; i < AXG_BOARD_REFUSALS; ++i) {
            EXPECT_EQ(board.refused[i], before[i] + (i == board.last_refusal ? 1U : 0U)) << i;
        }
        return board.last_refusal;
    }
    const std::uint64_t at = instant_of(4) + 400;
};

TEST_F(AxguardBoard, ZeroedMemoryMayNotMove) {
    EXPECT_FALSE(may_move(0));
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(axg_board_arm(&board, 1, 100'000), AXG_BOARD_ARMING_NO_OPTIONS);
}

// Rule 1
TEST_F(AxguardBoard, SixteenSamplesAreKeptAndNoMore) {
    begin();
    for (std::uint32_t number = 4; number <= 19; ++number) {
        ASSERT_TRUE(latch_at(number, instant_of(3) + 600 + number));
    }
    const std::uint64_t now = instant_of(3) + 700;
    EXPECT_EQ(refusal_of({.number = 3, .live = 5, .samples = 15}, now), AXG_BOARD_REFUSED_ECHO);
    EXPECT_EQ(refusal_of({.number = 4, .live = 6, .samples = 15}, now), AXG_BOARD_REFUSED_NOTHING);
}

TEST_F(AxguardBoard, SamplesOutOfOrderAreForgotten) {
    begin();
    EXPECT_FALSE(latch_at(3, instant_of(5)));
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_LATCH_ORDER);
}

// Rule 2
TEST_F(AxguardBoard, EachRefusalOfAPermitHasItsName) {
    begin();
    ASSERT_TRUE(latch(4));
    ASSERT_TRUE(latch(5));
    EXPECT_EQ(refusal_of({.word = 0x00, .number = 5, .live = 5}, at + 1000),
              AXG_BOARD_REFUSED_WORD);
    EXPECT_EQ(refusal_of({.number = 6, .live = 5}, at + 1000), AXG_BOARD_REFUSED_ECHO);
    EXPECT_EQ(refusal_of({.number = 5, .live = 5, .nonce = 0xC0FFEF}, at + 1000),
              AXG_BOARD_REFUSED_ANSWER);
    EXPECT_EQ(refusal_of({.number = 245, .live = 5}, at + 1000), AXG_BOARD_REFUSED_ANSWER);
    EXPECT_EQ(refusal_of({.number = 5, .live = 4}, at + 1000), AXG_BOARD_REFUSED_LIVE);
    EXPECT_EQ(refusal_of({.number = 5, .live = 20}, at + 1000), AXG_BOARD_REFUSED_LIVE);
    EXPECT_EQ(refusal_of({.number = 5, .live = 21, .cap = 251}, at + 1000),
              AXG_BOARD_REFUSED_VALUE);
    EXPECT_EQ(refusal_of({.number = 5, .live = 22, .level = 4}, at + 1000),
              AXG_BOARD_REFUSED_VALUE);
    EXPECT_EQ(refusal_of({.number = 5, .live = 23, .samples = 0}, at + 1000),
              AXG_BOARD_REFUSED_SAMPLES);
    EXPECT_EQ(refusal_of({.word = AXG_BOARD_WORD_JOG, .number = 5, .live = 24}, at + 1000),
              AXG_BOARD_REFUSED_JOG);
    EXPECT_EQ(refusal_of({.number = 5, .live = 25, .samples = 1}, instant_of(6)),
              AXG_BOARD_REFUSED_LATE);
    EXPECT_EQ(refusal_of({.number = 5, .live = 26}, instant_of(6)), AXG_BOARD_REFUSED_NOTHING);
    EXPECT_EQ(refusal_of({.number = 4, .live = 27}, instant_of(6)), AXG_BOARD_REFUSED_OLD_ECHO);
    axg_board_stop(&board, instant_of(6));
    EXPECT_EQ(refusal_of({.number = 5, .live = 28}, instant_of(6)), AXG_BOARD_REFUSED_STOPPED);
}

TEST_F(AxguardBoard, EachRefusalOfAFrameHasItsName) {
    begin();
    ASSERT_TRUE(latch(4));
    auto [plain, twin] = board_pair({.number = 4, .live = 5});
    const auto refused = [&](const axg_board_can_frame& frame, std::uint64_t now_us) {
        return axg_board_frame(&board, &frame, now_us) == AXG_BOARD_HEARD_REFUSED
                   ? board.last_refusal
                   : AXG_BOARD_REFUSED_NOTHING;
    };
    EXPECT_EQ(refused(twin, at), AXG_BOARD_REFUSED_TWIN_ALONE);
    EXPECT_EQ(refused(plain, at), AXG_BOARD_REFUSED_NOTHING);
    EXPECT_EQ(refused(plain, at), AXG_BOARD_REFUSED_TWIN_MISSING);
    EXPECT_EQ(refused(twin, at + 1001), AXG_BOARD_REFUSED_TWIN_LATE);
    EXPECT_EQ(refused(plain, at + 1001), AXG_BOARD_REFUSED_NOTHING);
    axg_board_can_frame other = twin;
    other.data[7] ^= 1U;
    EXPECT_EQ(refused(other, at + 1001), AXG_BOARD_REFUSED_TWIN_DIFFERS);
    for (axg_board_can_frame* const frame : {&plain, &twin}) {
        axg_board_can_frame odd = *frame;
        odd.length = 7;
        EXPECT_EQ(refused(odd, at + 1001), AXG_BOARD_REFUSED_SHAPE);
        odd = *frame;
        odd.is_fd = true;
        EXPECT_EQ(refused(odd, at + 1001), AXG_BOARD_REFUSED_SHAPE);
    }
}

// Rule (i): the low bits of a permit come again after sixteen, so one is named first within fifteen
// samples; then for as long as the axes slow down.
TEST(AxguardBoardCap, APermitIsNamedWhileTheAxesSlowDown) {
    BoardFixture fixture(AXG_BOARD_CAP_ENFORCED);
    fixture.begin();
    axg_board_caps bound{};
    std::memset(bound.of, 250, sizeof bound.of);
    (void)axg_board_keeps(&fixture.board, &bound, fixture.instant_of(3) + 600);
    axg_board_says says{};
    says.mode = 1;
    says.is_homed = true;
    for (std::uint32_t number = 4; number < 40; ++number) {
        (void)fixture.latch(number);
        EXPECT_EQ(axg_board_flags(&fixture.board, &says), 4U | 4U << 4U) << number;
        (void)fixture.hear({.number = number,
                            .live = static_cast<std::uint8_t>(number + 1),
                            .cap = 20,
                            .mask = 255},
                           fixture.instant_of(number) + 100);
    }
    std::memset(bound.of, 20, sizeof bound.of);
    (void)axg_board_keeps(&fixture.board, &bound, fixture.instant_of(39) + 600);
    (void)fixture.latch(40);
    EXPECT_EQ(axg_board_flags(&fixture.board, &says), 4U | (40U & 15U) << 4U);
}

TEST(AxguardBoardCap, APermitOfMoreThanFifteenSamplesAgoIsNotNamedFirst) {
    axg_board_says says{};
    says.is_homed = true;
    for (const std::uint32_t late : {15U, 16U}) {
        BoardFixture fixture(AXG_BOARD_CAP_ENFORCED);
        fixture.arm();
        axg_board_caps bound{};
        std::memset(bound.of, 250, sizeof bound.of);
        for (std::uint32_t number = 0; number < 4; ++number) {
            (void)fixture.latch(number);
            (void)fixture.hear({.number = number, .live = static_cast<std::uint8_t>(number + 1)},
                               fixture.instant_of(number) + 100);
            (void)axg_board_keeps(&fixture.board, &bound, fixture.instant_of(number) + 600);
        }
        (void)fixture.latch(4);
        (void)fixture.hear({.number = 4, .live = 5, .cap = 20, .mask = 255},
                           fixture.instant_of(4) + 100);
        for (std::uint32_t number = 5; number < 4 + late; ++number) {
            (void)fixture.latch(number);
            EXPECT_EQ(axg_board_flags(&fixture.board, &says), 4U | 4U << 4U) << number;
        }
        std::memset(bound.of, 20, sizeof bound.of);
        (void)axg_board_keeps(&fixture.board, &bound, fixture.instant_of(3 + late) + 600);
        (void)fixture.latch(4 + late);
        EXPECT_EQ(axg_board_flags(&fixture.board, &says), late == 15 ? 4U | 5U << 4U : 0U);
    }
}

// Rule (iii)
TEST(AxguardBoardCap, APermitWhoseSampleWasFasterThanItsProofIsRefusedForItsCap) {
    BoardFixture fixture(AXG_BOARD_CAP_ENFORCED);
    fixture.begin();
    axg_board_caps bound{};
    std::memset(bound.of, 20, sizeof bound.of);
    (void)axg_board_keeps(&fixture.board, &bound, fixture.instant_of(3) + 600);
    (void)fixture.latch(4);
    EXPECT_EQ(
        fixture.hear({.number = 4, .live = 5, .cap = 20, .mask = 255}, fixture.instant_of(4) + 100),
        AXG_BOARD_HEARD_PERMIT);
    (void)fixture.latch(5);
    EXPECT_EQ(
        fixture.hear({.number = 5, .live = 6, .cap = 90, .mask = 255}, fixture.instant_of(5) + 100),
        AXG_BOARD_HEARD_PERMIT);
    std::memset(bound.of, 90, sizeof bound.of);
    EXPECT_EQ(axg_board_keeps(&fixture.board, &bound, fixture.instant_of(5) + 200).of[0], 90);
    std::memset(bound.of, 10, sizeof bound.of);
    EXPECT_EQ(axg_board_keeps(&fixture.board, &bound, fixture.instant_of(5) + 300).of[0], 10);
    EXPECT_EQ(fixture.hear({.number = 5, .live = 7, .cap = 20, .mask = 255, .samples = 15},
                           fixture.instant_of(5) + 400),
              AXG_BOARD_HEARD_REFUSED);
    EXPECT_EQ(fixture.board.last_refusal, AXG_BOARD_REFUSED_CAP);
    EXPECT_EQ(axg_board_may_move(&fixture.board, fixture.instant_of(5) + 500).end_us,
              fixture.instant_of(5) + 10'000);
}

// Rules 3 to 5
TEST_F(AxguardBoard, MotionEndsAtTheEndAndOnlyAPersonLeadsOut) {
    begin();
    const std::uint64_t end = instant_of(3) + 10'000;
    EXPECT_TRUE(may_move(end - 1));
    EXPECT_FALSE(may_move(end));
    EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_PERMIT_ENDED);
    (void)latch_at(14, end + 10);
    EXPECT_EQ(refusal_of({.number = 14, .live = 5}, end + 20), AXG_BOARD_REFUSED_STOPPED);
    EXPECT_EQ(axg_board_arm(&board, 0xBEEF, end + 90'000), AXG_BOARD_ARMING_MOVES);
    axg_board_moves(&board, false, end + 90'000);
    EXPECT_EQ(axg_board_arm(&board, 0xBEEF, end + 105'999), AXG_BOARD_ARMING_REST);
    EXPECT_EQ(axg_board_arm(&board, 0xC0FFEE, end + 106'000), AXG_BOARD_ARMING_NONCE_AGAIN);
    EXPECT_EQ(axg_board_arm(&board, 0x1000000, end + 106'000), AXG_BOARD_ARMING_NONCE);
    EXPECT_EQ(axg_board_arm(&board, 0xBEEF, end + 106'000), AXG_BOARD_ARMING_DONE);
    EXPECT_FALSE(may_move(end + 106'001));
}

TEST_F(AxguardBoard, ATimeThatGoesBackwardsProlongsNothing) {
    begin();
    const std::uint64_t end = instant_of(3) + 10'000;
    EXPECT_FALSE(may_move(end + 1));
    EXPECT_FALSE(may_move(end - 5000));
    ASSERT_TRUE(latch_at(13, end + 2));
}

// Other nonces with the same checksum are refused: their answers would be the same.
TEST_F(AxguardBoard, ANonceThatTheAnswerDoesNotTellApartIsRefused) {
    arm();
    std::uint32_t same = 0;
    const auto mark = [](std::uint32_t nonce) {
        const std::array bytes{static_cast<std::uint8_t>(nonce),
                               static_cast<std::uint8_t>(nonce >> 8U),
                               static_cast<std::uint8_t>(nonce >> 16U)};
        return crc16_ccitt(bytes);
    };
    for (std::uint32_t nonce = 0; nonce <= AXG_BOARD_NONCE_MAX && same < 3; ++nonce) {
        if (nonce != 0xC0FFEE && mark(nonce) == mark(0xC0FFEE)) {
            ++same;
            EXPECT_EQ(axg_board_arm(&board, nonce, 200'000), AXG_BOARD_ARMING_NONCE_AGAIN);
        }
    }
    EXPECT_EQ(same, 3U);
}

// Counts stay where they are rather than begin again at 0.
TEST_F(AxguardBoard, CountsStayAtTheirLargestNumber) {
    begin();
    (void)latch(4);
    board.refused[AXG_BOARD_REFUSED_WORD] = UINT32_MAX - 1;
    board.permits = UINT32_MAX - 1;
    for (std::uint8_t i = 0; i < 3; ++i) {
        (void)hear({.word = 0x00, .number = 4}, at);
        (void)hear({.number = 4, .live = static_cast<std::uint8_t>(5 + i)}, at);
    }
    EXPECT_EQ(board.refused[AXG_BOARD_REFUSED_WORD], UINT32_MAX);
    EXPECT_EQ(board.permits, UINT32_MAX);
}

TEST_F(AxguardBoard, OtherFramesAreNoBusinessOfIt) {
    begin();
    axg_board_can_frame frame{};
    frame.id = 0x602;
    frame.length = 8;
    EXPECT_EQ(axg_board_frame(&board, &frame, at), AXG_BOARD_HEARD_NOTHING);
    frame.id = 0;  // options.hashes_id is 0: nothing is compared
    EXPECT_EQ(axg_board_frame(&board, &frame, at), AXG_BOARD_HEARD_NOTHING);
}

// Rule 8
TEST_F(AxguardBoard, TheHorizonIsRoundedUp) {
    options.period_us = 333;
    EXPECT_EQ(axg_board_horizon_us(&options, 1), 337U + 20 + 2000);
    options.period_us = 1000;
    EXPECT_EQ(axg_board_horizon_us(&options, 15), 15'150U + 20 + 2000);
}

}  // namespace
}  // namespace axg
