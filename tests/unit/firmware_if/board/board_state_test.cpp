// SPDX-License-Identifier: Apache-2.0
// Power-up, arming, latches, motion, hashes and tool changes of the library for boards: each
// condition of axguard_board.c on both sides. What a pair is refused for: axguard_board_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "firmware_if/board/axguard_board.h"
#include "tests/support/board_fixture.hpp"

namespace axg {
namespace {

using test::BoardFixture;
using test::BoardPermit;
using test::classical_frame;

constexpr std::uint32_t kHashes = 0x602;

class BoardState : public ::testing::Test, public BoardFixture {
  protected:
    /// The samples of these numbers, each with its permit 100 us later; live = number + 1.
    void permits(std::uint32_t first, std::uint32_t last, std::uint8_t samples = 10) {
        for (std::uint32_t number = first; number <= last; ++number) {
            ASSERT_TRUE(latch(number));
            (void)hear({.number = number,
                        .live = static_cast<std::uint8_t>(number + 1),
                        .samples = samples},
                       instant_of(number) + 100);
        }
    }
    bool good_options() { return axg_board_power_up(&board, &options, 0x123456, 0); }
    axg_board_heard hash(std::uint8_t part, std::uint32_t value, std::uint64_t at_us) {
        const auto byte = [value](unsigned i) { return static_cast<std::uint8_t>(value >> 8 * i); };
        return hear_frame(
            classical_frame(kHashes, {part, 1, 0, 0, byte(0), byte(1), byte(2), byte(3)}), at_us);
    }
    axg_board_heard hear_frame(const axg_board_can_frame& frame, std::uint64_t at_us) {
        return axg_board_frame(&board, &frame, at_us);
    }
    [[nodiscard]] std::uint64_t horizon_us() const { return axg_board_horizon_us(&options, 15); }
};

// --- Time -------------------------------------------------------------------------------------

TEST(BoardTime, AReadingIsExtendedToTheNearestInstant) {
    constexpr std::uint64_t kLast = 5'000'000'000;
    for (const std::int64_t off : {-2'000'000'000, -10, 0, 10, 2'000'000'000}) {
        const std::uint64_t wanted = kLast + static_cast<std::uint64_t>(off);
        EXPECT_EQ(axg_board_extend_us(kLast, static_cast<std::uint32_t>(wanted)), wanted) << off;
    }
}

TEST(BoardTime, NoReadingIsExtendedToBeforeTheStartOfTime) {
    EXPECT_EQ(axg_board_extend_us(16, 0), 0U);
    EXPECT_EQ(axg_board_extend_us(10, UINT32_MAX - 5), UINT32_MAX - 5ULL);
}

// --- Power-up ---------------------------------------------------------------------------------

TEST_F(BoardState, EveryOptionHasItsRange) {
    const axg_board_options good = options;
    const std::pair<std::function<void(axg_board_options&)>, bool> changes[] = {
        {[](auto& o) { o.period_us = 0; }, false},
        {[](auto& o) { o.period_us = 1; }, true},
        {[](auto& o) { o.period_us = AXG_BOARD_PERIOD_US_MAX; }, true},
        {[](auto& o) { o.period_us = AXG_BOARD_PERIOD_US_MAX + 1; }, false},
        {[](auto& o) { o.permit_samples_max = 0; }, false},
        {[](auto& o) { o.permit_samples_max = 1; }, true},
        {[](auto& o) { o.permit_samples_max = 15; }, true},
        {[](auto& o) { o.permit_samples_max = 16; }, false},
        {[](auto& o) { o.axis_count = 0; }, false},
        {[](auto& o) { o.axis_count = 1; }, true},
        {[](auto& o) { o.axis_count = AXG_BOARD_AXES_MAX; }, true},
        {[](auto& o) { o.axis_count = AXG_BOARD_AXES_MAX + 1; }, false}};
    for (const auto& [change, is_good] : changes) {
        options = good;
        change(options);
        EXPECT_EQ(good_options(), is_good);
        EXPECT_EQ(axg_board_arm(&board, 0xC0FFEE, 200'000'000),
                  is_good ? AXG_BOARD_ARMING_DONE : AXG_BOARD_ARMING_NO_OPTIONS);
    }
    options = good;
    EXPECT_TRUE(axg_board_power_up(&board, &options, AXG_BOARD_NONCE_MAX, 0));
    EXPECT_FALSE(axg_board_power_up(&board, &options, AXG_BOARD_NONCE_MAX + 1, 0));
}

TEST_F(BoardState, NobodyArmedSoNothingMoves) {
    ASSERT_TRUE(good_options());
    for (std::uint32_t number = 0; number < 6; ++number) {
        ASSERT_TRUE(latch(number));
        EXPECT_EQ(hear({.number = number,
                        .live = static_cast<std::uint8_t>(number + 1),
                        .nonce = 0x123456},
                       instant_of(number) + 100),
                  AXG_BOARD_HEARD_REFUSED);
        EXPECT_FALSE(may_move(instant_of(number) + 200)) << number;
    }
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_STOPPED);
    EXPECT_FALSE(axg_board_announce_tool(&board));
    axg_board_moves(&board, true, instant_of(5) + 300);
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_POWER_UP);
}

TEST_F(BoardState, BoundsOfSpeedBeginAtRestWhereTheyAreKeptAndAtRapidWhereNot) {
    for (const axg_board_cap_kind kind : {AXG_BOARD_CAP_IGNORED, AXG_BOARD_CAP_ENFORCED}) {
        options.cap_kind = kind;
        ASSERT_TRUE(good_options());
        for (const bool is_armed : {false, true}) {
            if (is_armed) {
                arm();
            }
            const axg_board_motion motion = axg_board_may_move(&board, 60'000);
            for (std::uint32_t i = 0; i < AXG_BOARD_CAP_GROUPS; ++i) {
                EXPECT_EQ(motion.keeps.of[i], kind == AXG_BOARD_CAP_ENFORCED ? 0 : 250) << i;
                EXPECT_EQ(motion.ordered.of[i], 0) << i;
            }
        }
    }
}

// --- Arming -----------------------------------------------------------------------------------

TEST_F(BoardState, ThreePermitsInARowAllowTheFirstMotion) {
    arm();
    permits(0, 2);  // the first one only sets the reference of the live counter
    const axg_board_motion two = axg_board_may_move(&board, instant_of(2) + 200);
    EXPECT_FALSE(two.may_move);
    EXPECT_EQ(two.end_us, 0U);
    EXPECT_EQ(two.word, AXG_BOARD_WORD_NONE);
    permits(3, 3);
    const axg_board_motion three = axg_board_may_move(&board, instant_of(3) + 200);
    EXPECT_TRUE(three.may_move);
    EXPECT_EQ(three.end_us, instant_of(3) + 10'000);
    EXPECT_EQ(three.word, AXG_BOARD_WORD_RUN);
}

TEST_F(BoardState, ARefusalBeginsTheRowAnewAndSoDoesAChange) {
    for (const bool is_change : {false, true}) {
        arm();
        permits(0, 2);
        if (is_change) {
            axg_board_change(&board, false, instant_of(2) + 200);
        } else {
            (void)hear({.word = 0x00, .number = 2}, instant_of(2) + 200);
        }
        permits(3, 4);
        EXPECT_FALSE(may_move(instant_of(4) + 200)) << is_change;
        permits(5, 5);
        EXPECT_TRUE(may_move(instant_of(5) + 200)) << is_change;
        (void)hear({.word = 0x00, .number = 5}, instant_of(5) + 300);
        EXPECT_TRUE(may_move(instant_of(5) + 400)) << "after the third neither matters";
    }
}

TEST_F(BoardState, ArmingForgetsAllOfBefore) {
    arm();
    permits(0, 5);
    EXPECT_TRUE(may_move(instant_of(5) + 200));
    axg_board_can_frame session{};
    ASSERT_TRUE(axg_board_encode_session(&board, {0x583, 0x583}, instant_of(5) + 200, &session));
    EXPECT_FALSE(axg_board_is_session_due(&board, instant_of(5) + 300));
    ASSERT_EQ(axg_board_arm(&board, 0xBEEF, instant_of(5) + 300), AXG_BOARD_ARMING_DONE);
    EXPECT_FALSE(may_move(instant_of(5) + 300));
    EXPECT_TRUE(axg_board_is_session_due(&board, instant_of(5) + 300));
    (void)hear({.number = 5, .live = 7, .nonce = 0xBEEF}, instant_of(5) + 400);
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_ECHO) << "latched before";
    ASSERT_TRUE(latch_at(2, instant_of(6))) << "with another nonce numbers may come again";
    EXPECT_TRUE(axg_board_is_session_due(&board, instant_of(6))) << "not sent yet";
    (void)hear({.number = 2, .live = 7, .nonce = 0xBEEF}, instant_of(6) + 100);
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_LIVE) << "the first sets the reference";
    for (std::uint8_t live = 8; live <= 10; ++live) {
        EXPECT_FALSE(may_move(instant_of(6) + 200));
        EXPECT_EQ(hear({.number = 2, .live = live, .nonce = 0xBEEF}, instant_of(6) + 200),
                  AXG_BOARD_HEARD_PERMIT);
    }
    EXPECT_TRUE(may_move(instant_of(6) + 200));
}

TEST_F(BoardState, RestIsSixteenStridesOfAtLeastAMillisecond) {
    const std::pair<std::uint32_t, std::uint64_t> rests[] = {
        {500, 16'000}, {1000, 16'000}, {2000, 32'000}};
    for (const auto& [period_us, rest_us] : rests) {
        options.period_us = period_us;
        ASSERT_TRUE(axg_board_power_up(&board, &options, 0x123456, 1'000'000));
        axg_board_moves(&board, false, 1'000'000 + rest_us / 2);  // it rests anyway
        EXPECT_EQ(axg_board_arm(&board, 0xC0FFEE, 1'000'000 + rest_us - 1), AXG_BOARD_ARMING_REST);
        EXPECT_EQ(axg_board_arm(&board, AXG_BOARD_NONCE_MAX, 1'000'000 + rest_us),
                  AXG_BOARD_ARMING_DONE);
    }
}

TEST_F(BoardState, AfterAnotherArmingTheWordStopIsNotYetAgain) {
    options.cap_kind = AXG_BOARD_CAP_ENFORCED;
    begin();
    axg_board_caps wanted{};
    std::fill_n(wanted.of, AXG_BOARD_CAP_GROUPS, std::uint8_t{250});
    EXPECT_EQ(axg_board_keeps(&board, &wanted, instant_of(3) + 600).of[0], 250);
    axg_board_moves(&board, false, instant_of(3) + 700);
    ASSERT_EQ(axg_board_arm(&board, 0xBEEF, instant_of(30)), AXG_BOARD_ARMING_DONE);
    EXPECT_EQ(axg_board_may_move(&board, instant_of(30)).keeps.of[0], 0) << "it rests";
    EXPECT_EQ(hear({.word = AXG_BOARD_WORD_STOP, .number = 3, .samples = 0}, instant_of(30) + 1),
              AXG_BOARD_HEARD_NOT_YET);
    EXPECT_EQ(board.phase, AXG_BOARD_ARMED);
}

TEST_F(BoardState, ATimeBeforeTheLatestCountsAsTheLatest) {
    arm();
    permits(0, 3);
    EXPECT_FALSE(may_move(instant_of(3) + 10'000));
    EXPECT_EQ(hear({.number = 3, .live = 5}, instant_of(3) + 200), AXG_BOARD_HEARD_REFUSED);
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_LATE);
}

// --- Latches ----------------------------------------------------------------------------------

TEST_F(BoardState, TheFirstSampleMayHaveAnyNumber) {
    for (const std::uint32_t lap : {0U, 40'000U, 65'535U}) {
        arm();
        const std::uint32_t first = lap * AXG_BOARD_SYNC_MAX;
        for (std::uint32_t i = 0; i < 4; ++i) {
            ASSERT_TRUE(latch_at(first + i, instant_of(i))) << lap;
            (void)hear({.number = first + i, .live = static_cast<std::uint8_t>(i)},
                       instant_of(i) + 100);
        }
        EXPECT_TRUE(may_move(instant_of(3) + 200)) << lap;
    }
}

TEST_F(BoardState, NumberAndStampOfALatchAreAfterTheLast) {
    const std::pair<std::function<bool()>, bool> latches[] = {
        {[&] { return latch_at(7, instant_of(3) + 1); }, true},
        {[&] { return latch_at(3, instant_of(4)); }, false},
        {[&] { return latch_at(2, instant_of(4)); }, false},
        {[&] { return latch_at(4, instant_of(3)); }, false},
        {[&] { return latch_at(4, instant_of(3) - 1); }, false}};
    for (const auto& [make, is_next] : latches) {
        begin();
        EXPECT_EQ(make(), is_next);
        EXPECT_EQ(board.phase, is_next ? AXG_BOARD_ARMED : AXG_BOARD_STOPPED);
        EXPECT_EQ(axg_board_is_session_due(&board, instant_of(300)), is_next)
            << "without a sample there is no session";
        arm();
        permits(0, 3);
        EXPECT_EQ(make(), is_next);
        EXPECT_EQ(board.phase, AXG_BOARD_ARMED) << "at rest nothing is latched";
        EXPECT_EQ(may_move(instant_of(4) + 200), is_next);
    }
}

TEST_F(BoardState, ASyncCounterIsOneTo240) {
    for (const unsigned sync : {0U, 241U, 255U}) {
        arm();
        const axg_board_sample sample{
            .latched_us = 100'000, .lap = 0, .sync = static_cast<std::uint8_t>(sync)};
        EXPECT_FALSE(axg_board_latch(&board, &sample)) << sync;
    }
}

TEST_F(BoardState, NothingLatchedBeforeAChangeIsAReasonToMove) {
    arm();
    permits(0, 3);
    const auto is_no_echo = [&](std::uint32_t number, std::uint8_t live) {
        return hear({.number = number, .live = live}, instant_of(3) + 700) ==
                   AXG_BOARD_HEARD_REFUSED &&
               board.last_refusal == AXG_BOARD_REFUSED_ECHO;
    };
    axg_board_change(&board, false, instant_of(3) + 500);
    EXPECT_FALSE(may_move(instant_of(3) + 600));
    EXPECT_TRUE(is_no_echo(3, 5));
    ASSERT_TRUE(latch_at(4, instant_of(3) + 499));
    EXPECT_TRUE(is_no_echo(4, 5)) << "stamped before it, handed in after it";
    ASSERT_TRUE(latch_at(5, instant_of(3) + 500));
    EXPECT_FALSE(is_no_echo(5, 5));
}

TEST_F(BoardState, AChangeBetweenTheFramesOfAPairEndsIt) {
    arm();
    permits(0, 3);
    const auto pair = test::board_pair({.number = 3, .live = 5});
    EXPECT_EQ(hear_frame(pair[0], instant_of(3) + 200), AXG_BOARD_HEARD_PLAIN);
    axg_board_change(&board, false, instant_of(3) + 300);
    EXPECT_EQ(hear_frame(pair[1], instant_of(3) + 400), AXG_BOARD_HEARD_REFUSED);
    EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_TWIN_ALONE);
}

TEST_F(BoardState, AnEndBeforeAChangeDoesNotHoldTheNextOneBack) {
    arm();
    permits(0, 3, 15);
    axg_board_change(&board, false, instant_of(3) + 500);
    ASSERT_TRUE(latch(4));
    EXPECT_EQ(hear({.number = 4, .live = 5, .samples = 2}, instant_of(4) + 100),
              AXG_BOARD_HEARD_PERMIT);
    EXPECT_EQ(axg_board_may_move(&board, instant_of(4) + 200).end_us, instant_of(4) + 2000);
}

// --- Motion and stops -------------------------------------------------------------------------

TEST_F(BoardState, AtRestAnEndPassesWithoutAStop) {
    arm();
    permits(0, 3);
    EXPECT_FALSE(may_move(instant_of(3) + 10'000));
    EXPECT_EQ(board.phase, AXG_BOARD_ARMED);
    ASSERT_TRUE(latch(14));
    EXPECT_EQ(hear({.number = 14, .live = 5}, instant_of(14) + 100), AXG_BOARD_HEARD_PERMIT);
    EXPECT_TRUE(may_move(instant_of(14) + 200));
}

TEST_F(BoardState, EveryCallWithATimeEndsMotionAtTheEnd) {
    const std::uint64_t end = instant_of(3) + 10'000;
    const axg_board_caps wanted{};
    const std::function<void(std::uint64_t)> calls[] = {
        [&](std::uint64_t at_us) { (void)may_move(at_us); },
        [&](std::uint64_t at_us) { (void)axg_board_keeps(&board, &wanted, at_us); },
        [&](std::uint64_t at_us) { axg_board_moves(&board, true, at_us); },
        [&](std::uint64_t at_us) { (void)axg_board_may_change_tool(&board, at_us); },
        [&](std::uint64_t at_us) { (void)hear_frame(classical_frame(0x777, {}), at_us); }};
    for (const auto& call : calls) {
        begin();
        call(end - 1);
        EXPECT_EQ(board.phase, AXG_BOARD_ARMED) << &call - calls;
        call(end);
        EXPECT_EQ(board.phase, AXG_BOARD_STOPPED) << &call - calls;
        EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_PERMIT_ENDED);
    }
}

TEST_F(BoardState, MotionWithoutPermissionIsAStop) {
    arm();
    permits(0, 2);
    axg_board_moves(&board, false, instant_of(2) + 200);
    EXPECT_EQ(board.phase, AXG_BOARD_ARMED);
    axg_board_moves(&board, true, instant_of(2) + 300);
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_NOT_PERMITTED);
}

TEST_F(BoardState, TheStopFrameIsObeyedWhateverItCarries) {
    for (const unsigned length : {0U, 1U, 8U}) {
        begin();
        axg_board_can_frame stop{};
        stop.id = options.stop_id;
        stop.length = static_cast<std::uint8_t>(length);
        EXPECT_EQ(hear_frame(stop, instant_of(3) + 600), AXG_BOARD_HEARD_STOP);
        EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
        EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_STOP_FRAME);
        EXPECT_FALSE(may_move(instant_of(3) + 700));
    }
}

TEST_F(BoardState, AChangeInMotionIsAStop) {
    begin();
    axg_board_change(&board, true, instant_of(3) + 600);
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_CHANGED);
}

// --- Hashes -----------------------------------------------------------------------------------

class BoardHashes : public BoardState {
  protected:
    BoardHashes() {
        options.hashes_id = kHashes;
        for (std::uint32_t i = 0; i < AXG_BOARD_HASH_PARTS; ++i) {
            options.hashes[i] = hash_of(i);
        }
    }
    static std::uint32_t hash_of(std::uint32_t part) { return 0x44332211U + 0x01010101U * part; }
    void all_equal(std::uint64_t at_us) {
        for (std::uint8_t part = 0; part < AXG_BOARD_HASH_PARTS; ++part) {
            EXPECT_EQ(hash(part, hash_of(part), at_us), AXG_BOARD_HEARD_HASH);
        }
    }
};

TEST_F(BoardHashes, AllFourAreEqualBeforeAnyMotion) {
    arm();
    permits(0, 3);
    const std::uint64_t at = instant_of(3) + 200;
    for (std::uint8_t part = 0; part < AXG_BOARD_HASH_PARTS; ++part) {
        EXPECT_FALSE(may_move(at)) << int{part};
        EXPECT_EQ(hash(part, hash_of(part), at), AXG_BOARD_HEARD_HASH);
    }
    EXPECT_TRUE(may_move(at));
    EXPECT_EQ(hash(2, hash_of(3), at), AXG_BOARD_HEARD_HASH_DIFFERS);
    EXPECT_FALSE(may_move(at));
    EXPECT_EQ(board.phase, AXG_BOARD_ARMED) << "at rest nothing is latched";
    EXPECT_EQ(hash(2, hash_of(2), at), AXG_BOARD_HEARD_HASH);
    EXPECT_TRUE(may_move(at));
}

TEST_F(BoardHashes, OneThatDiffersInMotionIsAStop) {
    arm();
    permits(0, 3);
    all_equal(instant_of(3) + 200);
    axg_board_moves(&board, true, instant_of(3) + 200);
    EXPECT_EQ(hash(1, hash_of(1), instant_of(3) + 300), AXG_BOARD_HEARD_HASH);
    EXPECT_EQ(board.phase, AXG_BOARD_ARMED);
    EXPECT_EQ(hash(1, 0, instant_of(3) + 400), AXG_BOARD_HEARD_HASH_DIFFERS);
    EXPECT_EQ(board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(board.cause, AXG_BOARD_CAUSE_HASH_DIFFERS);
}

TEST_F(BoardHashes, AFrameThatIsNoHashIsRefused) {
    arm();
    const axg_board_can_frame good = classical_frame(kHashes, {3, 1, 0, 0, 0x14, 0x25, 0x36, 0x47});
    ASSERT_EQ(hear_frame(good, 60'000), AXG_BOARD_HEARD_HASH);
    const std::function<void(axg_board_can_frame&)> changes[] = {
        [](auto& frame) { frame.is_fd = true; }, [](auto& frame) { frame.length = 7; },
        [](auto& frame) { frame.data[0] = 4; },  [](auto& frame) { frame.data[1] = 2; },
        [](auto& frame) { frame.data[2] = 1; },  [](auto& frame) { frame.data[3] = 1; }};
    std::uint32_t count = 0;
    for (const auto& change : changes) {
        axg_board_can_frame frame = good;
        change(frame);
        EXPECT_EQ(hear_frame(frame, 60'000), AXG_BOARD_HEARD_REFUSED) << count;
        EXPECT_EQ(board.last_refusal, AXG_BOARD_REFUSED_SHAPE);
        EXPECT_EQ(board.refused[AXG_BOARD_REFUSED_SHAPE], ++count);
    }
}

// --- Tool change ------------------------------------------------------------------------------

TEST_F(BoardState, AToolChangeBeginsAHorizonAfterTheFirstSampleThatAnnouncesIt) {
    arm();
    permits(0, 3);
    ASSERT_TRUE(axg_board_announce_tool(&board));
    EXPECT_FALSE(axg_board_may_change_tool(&board, instant_of(3) + 200));
    ASSERT_TRUE(axg_board_announce_tool(&board)) << "again is no new announcement";
    permits(4, 20, 15);
    ASSERT_TRUE(axg_board_announce_tool(&board));
    const std::uint64_t from = instant_of(4) + horizon_us();
    EXPECT_FALSE(axg_board_may_change_tool(&board, from - 1));
    EXPECT_TRUE(axg_board_may_change_tool(&board, from));
    axg_board_end_tool(&board);
    EXPECT_FALSE(axg_board_may_change_tool(&board, from)) << "over";
}

TEST_F(BoardState, WithoutAnAnnouncementOrAPermitNoToolIsChanged) {
    arm();
    permits(0, 30);
    EXPECT_FALSE(axg_board_may_change_tool(&board, instant_of(30) + 200)) << "not announced";
    ASSERT_TRUE(axg_board_announce_tool(&board));
    EXPECT_FALSE(axg_board_may_change_tool(&board, instant_of(30) + 200)) << "by no sample yet";
    arm();
    ASSERT_TRUE(axg_board_announce_tool(&board));
    for (std::uint32_t number = 0; number <= 30; ++number) {
        ASSERT_TRUE(latch(number));
    }
    EXPECT_FALSE(axg_board_may_change_tool(&board, instant_of(30) + 200)) << "no motion may begin";
}

TEST_F(BoardState, ASampleThatIsStampedAheadAnnouncesNothingYet) {
    arm();
    permits(0, 3);
    ASSERT_TRUE(axg_board_announce_tool(&board));
    ASSERT_TRUE(latch_at(4, instant_of(3) + 5000));
    EXPECT_FALSE(axg_board_may_change_tool(&board, instant_of(3) + 4000));
}

TEST_F(BoardState, AStopCancelsAToolChangeUntilAPersonArms) {
    arm();
    permits(0, 3);
    ASSERT_TRUE(axg_board_announce_tool(&board));
    axg_board_stop(&board, instant_of(3) + 200);
    EXPECT_FALSE(axg_board_announce_tool(&board));
    axg_board_end_tool(&board);
    ASSERT_EQ(axg_board_arm(&board, 0xBEEF, instant_of(3) + 300), AXG_BOARD_ARMING_DONE);
    EXPECT_TRUE(axg_board_announce_tool(&board));
}

TEST_F(BoardState, AnEndThatPassesCancelsWhatWasAnnouncedAndNothingElse) {
    for (const bool is_announced : {false, true}) {
        arm();
        permits(0, 3);
        if (is_announced) {
            ASSERT_TRUE(axg_board_announce_tool(&board));
        }
        EXPECT_FALSE(may_move(instant_of(3) + 10'000));
        axg_board_end_tool(&board);
        EXPECT_EQ(axg_board_announce_tool(&board), !is_announced);
    }
}

// Before the first permit there is no end that could pass.
TEST_F(BoardState, AnAnnouncementBeforeTheFirstPermitHolds) {
    arm();
    ASSERT_TRUE(axg_board_announce_tool(&board));
    EXPECT_FALSE(may_move(instant_of(0)));
    EXPECT_TRUE(axg_board_announce_tool(&board));
}

}  // namespace
}  // namespace axg
