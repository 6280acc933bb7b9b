// SPDX-License-Identifier: Apache-2.0
// Guard and board number laps on their own: they agree over every border of a lap and of 65,536
// laps, wherever the guard's numbers began; samples that are whole laps late do not.
#include "firmware_if/receiver/session_watch.hpp"

#include <gtest/gtest.h>

#include "tests/support/board_fixture.hpp"

namespace axg {
namespace {

/// The session of the board's sample `number`.
Session session_of(std::uint64_t number, std::uint32_t nonce = 7) {
    return {.nonce = nonce,
            .lap = static_cast<std::uint16_t>(number / kSyncCounterMax),
            .sync_counter = sync_counter_of(number)};
}

TEST(SessionWatch, LapsAgreeWhereverNumbersBegan) {
    for (const std::uint64_t laps : {0U, 1U, 77U, 65'535U}) {  // the board is that many ahead
        for (const std::uint64_t first : {0U, 1U, 130U, 239U}) {
            SessionWatch watch;
            const std::uint64_t board = 240 * laps;
            EXPECT_EQ(watch.on_session(session_of(board + first), first), SessionStatus::begun);
            for (std::uint64_t k = first; k < first + 1000; k += 7) {
                EXPECT_EQ(watch.lap_of(k), session_of(board + k).lap) << k;
                EXPECT_EQ(watch.on_session(session_of(board + k), k), SessionStatus::agrees) << k;
            }
        }
    }
}

// The frame leaves before the sample's own frames, or some samples after them.
TEST(SessionWatch, TheFrameMayBeSomeSamplesAheadOrBehind) {
    SessionWatch watch;
    EXPECT_EQ(watch.on_session(session_of(240 * 5 + 1), 0), SessionStatus::begun);
    for (std::uint64_t k = 300; k < 800; ++k) {
        for (std::uint64_t other = k - 100; other <= k + 100; other += 9) {
            EXPECT_EQ(watch.on_session(session_of(240 * 5 + other), k), SessionStatus::agrees);
        }
    }
    SessionWatch before;  // the board's sample is before the receiver's number 0
    EXPECT_EQ(before.on_session(session_of(239), 0), SessionStatus::begun);
    EXPECT_EQ(before.lap_of(0), 1);
}

TEST(SessionWatch, SamplesThatAreWholeLapsLateDoNotAgree) {
    SessionWatch watch;
    EXPECT_EQ(watch.on_session(session_of(1000), 1000), SessionStatus::begun);
    EXPECT_EQ(watch.on_session(session_of(1340), 1100), SessionStatus::held_up);
    EXPECT_EQ(watch.on_session(session_of(1100), 1340), SessionStatus::held_up);
    EXPECT_EQ(watch.on_session(session_of(1340), 1340), SessionStatus::agrees);
}

TEST(SessionWatch, AnotherNonceBeginsAnew) {
    SessionWatch watch;
    EXPECT_FALSE(watch.has_session());
    EXPECT_EQ(watch.on_session(session_of(1000), 1000), SessionStatus::begun);
    EXPECT_EQ(watch.on_session(session_of(3, 8), 1203), SessionStatus::begun);
    EXPECT_EQ(watch.nonce(), 8U);
    EXPECT_EQ(watch.lap_of(1203), 0);
    EXPECT_EQ(watch.on_session(session_of(243, 8), 1443), SessionStatus::agrees);
}

// End to end: a permit that the guard answers by this watch is one for the library of boards.
TEST(SessionWatch, ABoardTakesPermitsThatAnswerForIt) {
    test::BoardFixture fixture;
    fixture.arm();
    SessionWatch watch;
    for (std::uint32_t number = 65'536 * 240 - 300, k = 60; k < 700; ++number, ++k) {
        const std::uint32_t wrapped = number % (65'536 * 240);
        const std::uint64_t now_us = 100'000 + std::uint64_t{1000} * k;
        ASSERT_TRUE(fixture.latch_at(wrapped, now_us));
        if (axg_board_is_session_due(&fixture.board, now_us)) {
            axg_board_can_frame made{};
            ASSERT_TRUE(axg_board_encode_session(&fixture.board, {0x583, 0x583}, now_us, &made));
            CanFrame frame;
            frame.id = made.id;
            frame.length_bytes = made.length;
            std::copy_n(made.data, 8, frame.data.begin());
            Session session;
            ASSERT_EQ(decode_session(0x583, frame, session), FrameStatus::ok);
            ASSERT_NE(watch.on_session(session, k + 120), SessionStatus::held_up);
        }
        const auto pair = encode_permit({},
                                        {.word = PermitWord::run,
                                         .sync_counter = sync_counter_of(k + 120),
                                         .live_counter = static_cast<std::uint8_t>(k),
                                         .known_answer_signature = 0xC5A3,
                                         .samples = 10,
                                         .nonce = watch.nonce(),
                                         .lap = watch.lap_of(k + 120)},
                                        0);
        axg_board_heard heard = AXG_BOARD_HEARD_NOTHING;
        for (const CanFrame& frame : pair) {
            axg_board_can_frame received{};
            received.id = frame.id;
            received.length = 8;
            std::copy_n(frame.data.begin(), 8, received.data);
            heard = axg_board_frame(&fixture.board, &received, now_us + 400);
        }
        ASSERT_EQ(heard, k == 60 ? AXG_BOARD_HEARD_REFUSED : AXG_BOARD_HEARD_PERMIT) << k;
    }
    EXPECT_TRUE(fixture.may_move(fixture.board.now_us));
}

}  // namespace
}  // namespace axg
