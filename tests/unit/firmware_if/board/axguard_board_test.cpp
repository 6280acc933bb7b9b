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

TEST_F(AxguardBoard, EachWordThatLetsMoveIsHandedOn) {
    begin();
    for (const axg_board_word word : {AXG_BOARD_WORD_SLOW, AXG_BOARD_WORD_RUN}) {
        const auto live = static_cast<std::uint8_t>(board.live + 1);
        ASSERT_EQ(
            hear({.word = static_cast<std::uint8_t>(word), .number = 3, .live = live, .level = 3},
                 at),
            AXG_BOARD_HEARD_PERMIT);
        const axg_board_motion motion = axg_board_may_move(&board, at);
        EXPECT_EQ(motion.word, word);
        EXPECT_EQ(motion.level, 3);
    }
    axg_board_moves(&board, false, at);
    axg_board_change(&board, true, at);
    ASSERT_TRUE(latch_at(4, at + 1));
    ASSERT_EQ(
        hear({.word = AXG_BOARD_WORD_JOG, .number = 4, .live = 7, .cap = 251, .mask = 255}, at + 2),
        AXG_BOARD_HEARD_PERMIT)
        << "with jog the cap is not read";
    EXPECT_EQ(axg_board_may_move(&board, at + 3).word, AXG_BOARD_WORD_JOG);
    EXPECT_EQ(axg_board_may_move(&board, at + 3).ordered.of[0], 250);
    EXPECT_EQ(refusal_of({.number = 4, .live = 8}, at + 4), AXG_BOARD_REFUSED_JOG);
}

TEST_F(AxguardBoard, BoundsOfAPermitAreInclusive) {
    options.permit_samples_max = 12;
    begin();
    ASSERT_TRUE(latch(4));
    EXPECT_EQ(refusal_of({.number = 4, .live = 19, .samples = 12}, at), AXG_BOARD_REFUSED_NOTHING)
        << "15 ahead";
    EXPECT_EQ(refusal_of({.number = 4, .live = 35, .samples = 12}, at), AXG_BOARD_REFUSED_LIVE)
        << "16 ahead";
    EXPECT_EQ(refusal_of({.number = 4, .live = 36, .samples = 13}, at), AXG_BOARD_REFUSED_SAMPLES);
    auto [plain, twin] = board_pair({.number = 4, .live = 37});
    EXPECT_EQ(axg_board_frame(&board, &plain, at), AXG_BOARD_HEARD_PLAIN);
    EXPECT_EQ(axg_board_frame(&board, &twin, at + 1000), AXG_BOARD_HEARD_PERMIT) << "T later";
}

TEST_F(AxguardBoard, ASampleThatIsStampedAfterNowOrHasNoCounterIsNoEcho) {
    begin();
    ASSERT_TRUE(latch_at(4, at + 10));
    EXPECT_EQ(refusal_of({.number = 4, .live = 5}, at + 9), AXG_BOARD_REFUSED_ECHO);
    EXPECT_EQ(refusal_of({.number = 4, .live = 5}, at + 10), AXG_BOARD_REFUSED_NOTHING);
    for (const unsigned echo : {0U, 241U, 245U}) {  // 245 is 5 after a lap
        auto [plain, twin] = board_pair({.number = 4, .live = 6});
        plain.data[1] = static_cast<std::uint8_t>(echo);
        twin.data[1] = static_cast<std::uint8_t>(~echo);
        (void)axg_board_frame(&board, &plain, at + 20);
        EXPECT_EQ(axg_board_frame(&board, &twin, at + 20), AXG_BOARD_HEARD_REFUSED);
        EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_ECHO) << echo;
    }
}

// Sample 19 was lost: in its place among the records is sample 3.
TEST_F(AxguardBoard, ASampleThatWasLostIsNoEcho) {
    begin();
    ASSERT_TRUE(latch_at(20, at));
    EXPECT_EQ(refusal_of({.number = 19, .live = 5, .samples = 15}, at), AXG_BOARD_REFUSED_ECHO);
}

TEST_F(AxguardBoard, AfterAChangeNothingIsOrdered) {
    begin();
    EXPECT_EQ(axg_board_may_move(&board, at).ordered.of[0], 250);
    axg_board_moves(&board, false, at);
    axg_board_change(&board, false, at);
    EXPECT_EQ(axg_board_may_move(&board, at).ordered.of[0], 0);
    EXPECT_EQ(axg_board_may_move(&board, at).level, 0);
}

TEST_F(AxguardBoard, APermitWithAnEarlierEndShortensNothing) {
    begin();
    ASSERT_TRUE(latch(4));
    ASSERT_EQ(hear({.number = 4, .live = 5, .samples = 3}, at), AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(axg_board_may_move(&board, at).end_us, instant_of(3) + 10'000);
}

TEST_F(AxguardBoard, AFrameOfTheWrongShapeEndsThePairThatWaits) {
    begin();
    ASSERT_TRUE(latch(4));
    const auto [plain, twin] = board_pair({.number = 4, .live = 5});
    for (const bool is_twin : {false, true}) {
        axg_board_can_frame odd = is_twin ? twin : plain;
        odd.length = 7;
        (void)axg_board_frame(&board, &plain, at);
        const std::uint32_t before = board.refused[AXG_BOARD_REFUSED_SHAPE];
        EXPECT_EQ(axg_board_frame(&board, &odd, at), AXG_BOARD_HEARD_REFUSED);
        EXPECT_EQ(board.refused[AXG_BOARD_REFUSED_SHAPE], before + 1);
        EXPECT_EQ(axg_board_frame(&board, &twin, at), AXG_BOARD_HEARD_REFUSED);
        EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_TWIN_ALONE) << is_twin;
    }
}

// The word stop is obeyed whatever it echoes or answers; a right answer moves the live reference.
TEST_F(AxguardBoard, TheWordStopStopsAfterTheFirstMotionAndIsNotYetBefore) {
    const auto stop = [&](std::uint32_t number, std::uint8_t live, std::uint32_t nonce = 0xC0FFEE) {
        return hear({.word = AXG_BOARD_WORD_STOP,
                     .number = number,
                     .live = live,
                     .samples = 0,
                     .nonce = nonce},
                    at);
    };
    arm();
    for (std::uint32_t number = 0; number <= 4; ++number) {
        ASSERT_TRUE(latch(number));
    }
    EXPECT_EQ(stop(4, 4), AXG_BOARD_HEARD_NOT_YET);
    EXPECT_EQ(refusal_of({.number = 4, .live = 5}, at), AXG_BOARD_REFUSED_NOTHING);
    EXPECT_EQ(stop(4, 6), AXG_BOARD_HEARD_NOT_YET);
    EXPECT_EQ(refusal_of({.number = 4, .live = 6}, at), AXG_BOARD_REFUSED_LIVE);
    EXPECT_EQ(stop(4, 9, 0xBEEF), AXG_BOARD_HEARD_NOT_YET);
    EXPECT_EQ(stop(100, 9), AXG_BOARD_HEARD_NOT_YET) << "there is no such sample";
    EXPECT_EQ(refusal_of({.number = 4, .live = 9}, at), AXG_BOARD_REFUSED_NOTHING)
        << "of wrong answers nothing was taken";
    for (const std::uint32_t number : {3U, 100U}) {
        begin();
        EXPECT_EQ(stop(number, 5), AXG_BOARD_HEARD_STOP);
        EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
        EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_STOP_WORD);
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

/// A board that keeps caps, in motion; its samples named permits of no cap so far.
class AxguardBoardBounds : public ::testing::Test, public BoardFixture {
  protected:
    AxguardBoardBounds() : BoardFixture(AXG_BOARD_CAP_ENFORCED) {}
    void SetUp() override {
        begin();
        (void)keep(250, instant_of(3) + 600);
    }
    axg_board_caps keep(std::uint8_t bound, std::uint64_t at_us) {
        axg_board_caps wanted{};
        std::memset(wanted.of, bound, sizeof wanted.of);
        return axg_board_keeps(&board, &wanted, at_us);
    }
    /// A sample that names a permit of cap 20, which is kept.
    void slow_down() {
        (void)keep(20, instant_of(3) + 700);
        (void)latch(4);
        (void)hear({.number = 4, .live = 5, .cap = 20, .mask = 255}, instant_of(4) + 100);
        (void)latch(5);
        (void)hear({.number = 5, .live = 6, .cap = 20, .mask = 255}, instant_of(5) + 100);
    }
};

TEST_F(AxguardBoardBounds, TheMaskBindsItsAxesAndNoOthers) {
    (void)latch(4);
    ASSERT_EQ(hear({.number = 4, .live = 5, .cap = 20, .mask = 0x85}, instant_of(4) + 100),
              AXG_BOARD_HEARD_PERMIT);
    const axg_board_caps ordered = axg_board_may_move(&board, instant_of(4) + 200).ordered;
    for (unsigned i = 0; i < AXG_BOARD_CAP_GROUPS; ++i) {
        EXPECT_EQ(ordered.of[i], (0x85U >> i & 1U) != 0 ? 20 : 250) << i;
    }
}

TEST_F(AxguardBoardBounds, AGroupWithoutAnAxisKeepsNothing) {
    const axg_board_caps kept = keep(250, instant_of(3) + 650);
    for (std::uint32_t i = 0; i < AXG_BOARD_CAP_GROUPS; ++i) {
        EXPECT_EQ(kept.of[i], i < options.axis_count ? 250 : 0) << i;
    }
}

TEST_F(AxguardBoardBounds, ARaiseIsAtMostThatOfThePermitAndNeverInAStop) {
    slow_down();
    (void)latch(6);
    ASSERT_EQ(hear({.number = 6, .live = 7, .cap = 90, .mask = 255}, instant_of(6) + 100),
              AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(keep(60, instant_of(6) + 200).of[0], 60);
    EXPECT_EQ(keep(250, instant_of(6) + 300).of[0], 90);
    EXPECT_EQ(hear({.number = 6, .live = 8, .cap = 90, .mask = 255}, instant_of(6) + 350),
              AXG_BOARD_HEARD_PERMIT)
        << "of the two caps the larger counts";
    axg_board_stop(&board, instant_of(6) + 400);
    EXPECT_EQ(keep(20, instant_of(6) + 500).of[0], 20);
    EXPECT_EQ(keep(90, instant_of(6) + 600).of[0], 20);
}

// The permit that counted last has the end in force, is the newest, and no axis is above it.
TEST_F(AxguardBoardBounds, ARaiseWaitsForThePermitThatAllowsIt) {
    slow_down();
    (void)latch(6);
    ASSERT_EQ(
        hear({.number = 6, .live = 7, .cap = 90, .mask = 255, .samples = 3}, instant_of(6) + 100),
        AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(keep(90, instant_of(6) + 200).of[0], 20) << "an older permit ends later";
    (void)latch(7);
    ASSERT_EQ(hear({.number = 7, .live = 8, .cap = 90, .mask = 255}, instant_of(7) + 100),
              AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(keep(90, instant_of(7) + 200).of[0], 90);
    (void)latch(8);
    ASSERT_EQ(hear({.number = 8, .live = 9, .cap = 30, .mask = 1}, instant_of(8) + 100),
              AXG_BOARD_HEARD_PERMIT);
    const axg_board_caps kept = keep(250, instant_of(8) + 200);
    EXPECT_EQ(kept.of[0], 90);
    EXPECT_EQ(kept.of[1], 90) << "axis 0 still has to slow down for the same permit";
}

TEST_F(AxguardBoardBounds, AfterAPermitThatIsRefusedForItsCapNothingRises) {
    slow_down();
    (void)latch(6);
    ASSERT_EQ(hear({.number = 6, .live = 7, .cap = 90, .mask = 255}, instant_of(6) + 100),
              AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(keep(50, instant_of(6) + 200).of[0], 50);
    ASSERT_EQ(hear({.number = 6, .live = 8, .cap = 20, .mask = 255}, instant_of(6) + 300),
              AXG_BOARD_HEARD_REFUSED);
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_CAP);
    EXPECT_EQ(keep(90, instant_of(6) + 400).of[0], 50);
}

// What an axis was since the latch stays, however often it slowed down since.
TEST_F(AxguardBoardBounds, ALaterRaiseDoesNotHideAnEarlierOne) {
    slow_down();
    (void)latch(6);
    ASSERT_EQ(hear({.number = 6, .live = 7, .cap = 90, .mask = 255}, instant_of(6) + 100),
              AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(keep(90, instant_of(6) + 200).of[0], 90);
    EXPECT_EQ(keep(20, instant_of(6) + 300).of[0], 20);
    EXPECT_EQ(keep(50, instant_of(6) + 400).of[0], 50);
    EXPECT_EQ(hear({.number = 6, .live = 8, .cap = 50, .mask = 255}, instant_of(6) + 500),
              AXG_BOARD_HEARD_REFUSED);
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_CAP);
}

TEST_F(AxguardBoardBounds, AfterAChangeNoSampleNamesAPermitOfBefore) {
    axg_board_says says{};
    says.is_homed = true;
    slow_down();
    (void)latch(6);
    EXPECT_EQ(axg_board_flags(&board, &says), 4U | 6U << 4U);
    axg_board_moves(&board, false, instant_of(6) + 100);
    axg_board_change(&board, false, instant_of(6) + 200);
    (void)latch(7);
    EXPECT_EQ(axg_board_flags(&board, &says), 0U);
}

// A bound that fell between a stamp and its latch: what it was at the stamp is not known.
TEST_F(AxguardBoardBounds, ASampleFromBeforeTheLastChangeCountsAsRapid) {
    for (const bool is_before : {false, true}) {
        begin();
        (void)keep(250, instant_of(3) + 600);
        slow_down();
        (void)keep(15, instant_of(5) + 300);
        (void)keep(15, instant_of(5) + 900);  // no change
        (void)latch_at(6, instant_of(5) + (is_before ? 299 : 300));
        EXPECT_EQ(hear({.number = 6, .live = 7, .cap = 20, .mask = 255, .samples = 15},
                       instant_of(6) + 100),
                  is_before ? AXG_BOARD_HEARD_REFUSED : AXG_BOARD_HEARD_PERMIT);
        EXPECT_EQ(board.last_refusal == AXG_BOARD_REFUSED_CAP, is_before);
    }
}

TEST_F(AxguardBoard, ABoardThatKeepsNoCapKeepsRapid) {
    begin();
    const axg_board_caps wanted{};
    EXPECT_EQ(axg_board_keeps(&board, &wanted, at).of[0], 250);
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
