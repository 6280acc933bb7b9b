// SPDX-License-Identifier: Apache-2.0
// The simulated board: what the library for boards makes of the guard's frames becomes ends, stops
// and session frames of this board.
#include "hil_replay/board/permit_watch.hpp"

#include <gtest/gtest.h>

#include "core/collision/known_answer.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {
namespace {

constexpr std::int64_t kSampleZeroUs = 1'000'000;

/// A board that latches a sample every 1 ms, and a guard that knows its session.
struct PermitFixture {
    explicit PermitFixture(bool is_jogging = false, std::int64_t permit_us = 0)
        : watch(layout, is_jogging, permit_us) {}

    void latch() {
        watch.on_latch(sync_counter_of(next), instant_of(next));
        CanFrame frame;
        if (watch.take_session(instant_of(next), frame)) {
            ++sessions;
            EXPECT_EQ(decode_session(layout.session_in_id, frame, session), FrameStatus::ok);
        }
        ++next;
    }
    void latch_until(std::uint64_t count) {
        while (next < count) {
            latch();
        }
    }
    [[nodiscard]] static std::int64_t instant_of(std::uint64_t sample) {
        return kSampleZeroUs + 1000 * static_cast<std::int64_t>(sample);
    }
    Permit permit(std::uint64_t sample, PermitWord word = PermitWord::run) {
        return {.word = word,
                .sync_counter = sync_counter_of(sample),
                .live_counter = ++live,
                .known_answer_signature = kKnownAnswerSignature,
                .samples = static_cast<std::uint8_t>(word == PermitWord::stop ? 0 : 3),
                .nonce = session.nonce,
                .lap = static_cast<std::uint16_t>(sample / 240)};
    }
    void send(const Permit& permit, std::int64_t time_us) {
        for (const CanFrame& frame : encode_permit(layout, permit, time_us)) {
            watch.on_frame(frame);
        }
    }
    /// Samples, each with its permit 0.5 ms later.
    void run(std::uint64_t count) {
        for (std::uint64_t i = 0; i < count; ++i) {
            latch();
            send(permit(next - 1), instant_of(next - 1) + 500);
        }
    }

    CanLayout layout;
    PermitWatch watch;
    std::uint64_t next = 0;
    Session session{};
    int sessions = 0;
    std::uint8_t live = 0;
};

// The first pair only begins the live counter; then three in a row.
TEST(PermitWatch, TheFirstMotionNeedsThreePermitsInARow) {
    PermitFixture fixture;
    fixture.run(3);
    EXPECT_EQ(fixture.watch.valid_until_us(), INT64_MIN);
    EXPECT_EQ(fixture.watch.permits(), 2U);
    EXPECT_EQ(fixture.watch.refused(), 1U);
    fixture.run(1);
    EXPECT_EQ(fixture.watch.certified_us(), kSampleZeroUs + 3000);
    EXPECT_EQ(fixture.watch.valid_until_us(), kSampleZeroUs + 6000);
}

TEST(PermitWatch, APermitHoldsForNPeriodsFromItsSampleOverEveryLap) {
    PermitFixture fixture;
    fixture.run(700);
    EXPECT_EQ(fixture.watch.permits(), 699U);
    EXPECT_EQ(fixture.watch.valid_until_us(), PermitFixture::instant_of(699) + 3000);
    EXPECT_EQ(fixture.watch.speed_cap(), 250);
    EXPECT_FALSE(fixture.watch.is_slow());
}

TEST(PermitWatch, AnAnswerForAnotherLapOrNonceIsNone) {
    PermitFixture fixture;
    fixture.run(300);
    const std::uint64_t before = fixture.watch.permits();
    fixture.latch();
    Permit other = fixture.permit(300);
    other.lap = 0;
    fixture.send(other, PermitFixture::instant_of(300) + 300);
    other = fixture.permit(300);
    other.nonce ^= 1;
    fixture.send(other, PermitFixture::instant_of(300) + 400);
    EXPECT_EQ(fixture.watch.permits(), before);
    fixture.send(fixture.permit(300), PermitFixture::instant_of(300) + 500);
    EXPECT_EQ(fixture.watch.permits(), before + 1);
}

TEST(PermitWatch, AdviceIsThatOfTheNewestPermit) {
    PermitFixture fixture;
    fixture.run(9);
    fixture.latch();
    Permit slow = fixture.permit(9, PermitWord::slow);
    slow.cap = 60;
    slow.mask = 0xFF;
    fixture.send(slow, PermitFixture::instant_of(9) + 500);
    EXPECT_TRUE(fixture.watch.is_slow());
    EXPECT_EQ(fixture.watch.speed_cap(), 60);
    EXPECT_EQ(fixture.watch.valid_until_us(), PermitFixture::instant_of(9) + 3000);
    EXPECT_EQ(fixture.watch.ack_flags(), 0) << "this board promises no cap, so it names no permit";
}

TEST(PermitWatch, InMotionAPermitMustComeBeforeTheLastRanOut) {
    for (const bool is_moving : {false, true}) {
        PermitFixture fixture;
        fixture.run(10);
        if (is_moving) {
            fixture.watch.begin(PermitFixture::instant_of(10) - 100);
        }
        fixture.latch_until(13);  // that of sample 9 ends with sample 12
        fixture.send(fixture.permit(12), PermitFixture::instant_of(12) + 500);
        EXPECT_EQ(fixture.watch.certified_us(), PermitFixture::instant_of(is_moving ? 9 : 12));
    }
}

// After a motion that ended by itself the next one may begin.
TEST(PermitWatch, AtRestAPermitMayRunOut) {
    PermitFixture fixture;
    fixture.run(10);
    fixture.watch.begin(PermitFixture::instant_of(10) - 100);
    fixture.watch.rest(PermitFixture::instant_of(10));
    fixture.latch_until(13);
    fixture.send(fixture.permit(12), PermitFixture::instant_of(12) + 500);
    EXPECT_EQ(fixture.watch.certified_us(), PermitFixture::instant_of(12));
}

TEST(PermitWatch, TheStopFrameAndInMotionTheWordStopItFromTheirArrival) {
    PermitFixture frame;
    frame.run(10);
    frame.watch.on_frame(encode_stop(frame.layout, PermitFixture::instant_of(9) + 600));
    frame.watch.on_frame(encode_stop(frame.layout, PermitFixture::instant_of(9) + 900));
    EXPECT_EQ(frame.watch.stopped_us(), PermitFixture::instant_of(9) + 600);
    for (const bool is_moving : {false, true}) {
        PermitFixture word;
        word.run(10);
        if (is_moving) {
            word.watch.begin(PermitFixture::instant_of(9) + 500);
        }
        word.send(word.permit(9, PermitWord::stop), PermitFixture::instant_of(9) + 700);
        EXPECT_EQ(word.watch.stopped_us(), is_moving ? PermitFixture::instant_of(9) + 700 : kNever);
    }
}

TEST(PermitWatch, AJogAndAnyOtherMotionNeedWordsOfTheirOwn) {
    for (const bool is_jogging : {false, true}) {
        for (const PermitWord word : {PermitWord::run, PermitWord::slow, PermitWord::jog}) {
            PermitFixture fixture(is_jogging);
            for (int i = 0; i < 6; ++i) {
                fixture.latch();
                fixture.send(fixture.permit(fixture.next - 1, word),
                             PermitFixture::instant_of(fixture.next - 1) + 500);
            }
            EXPECT_EQ(fixture.watch.permits(), (word == PermitWord::jog) == is_jogging ? 5U : 0U);
        }
    }
}

TEST(PermitWatch, ABoardWithAWrongTimerBelievesAPermitForAsLongAsThatSays) {
    PermitFixture fixture(false, 500'000);
    fixture.run(10);
    fixture.watch.begin(PermitFixture::instant_of(10) - 100);
    fixture.latch_until(20);
    EXPECT_EQ(fixture.watch.valid_until_us(), PermitFixture::instant_of(9) + 500'000);
    EXPECT_EQ(fixture.watch.stopped_us(), kNever);
}

TEST(PermitWatch, ASessionFrameLeavesAtOnceEvery100MsAndWithEachLap) {
    PermitFixture fixture;
    fixture.latch();
    EXPECT_EQ(fixture.sessions, 1);
    EXPECT_EQ(fixture.session.lap, 0);
    fixture.latch_until(100);
    EXPECT_EQ(fixture.sessions, 1);
    fixture.latch_until(101);
    EXPECT_EQ(fixture.sessions, 2);
    fixture.latch_until(241);
    EXPECT_EQ(fixture.sessions, 4);
    EXPECT_EQ(fixture.session.lap, 1);
    EXPECT_EQ(fixture.session.sync_counter, 1);
}

TEST(PermitWatch, AnAcknowledgedStopHasANewNonce) {
    PermitFixture fixture;
    fixture.run(10);
    const std::uint32_t nonce = fixture.session.nonce;
    const std::int64_t stop_us = PermitFixture::instant_of(9) + 600;
    fixture.watch.on_frame(encode_stop(fixture.layout, stop_us));
    fixture.watch.acknowledge(stop_us + 1999);
    EXPECT_EQ(fixture.watch.stopped_us(), stop_us) << "the guard may still say stop";
    fixture.watch.acknowledge(stop_us + 2000);
    EXPECT_EQ(fixture.watch.stopped_us(), kNever);
    EXPECT_EQ(fixture.watch.valid_until_us(), INT64_MIN);
    fixture.send(fixture.permit(9), stop_us + 2100);
    fixture.latch_until(13);
    EXPECT_NE(fixture.session.nonce, nonce);
    fixture.run(3);
    EXPECT_EQ(fixture.watch.valid_until_us(), INT64_MIN);
    fixture.run(1);
    EXPECT_EQ(fixture.watch.valid_until_us(), PermitFixture::instant_of(16) + 3000);
}

}  // namespace
}  // namespace axg
