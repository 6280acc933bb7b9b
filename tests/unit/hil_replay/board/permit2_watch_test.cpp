// SPDX-License-Identifier: Apache-2.0
// The simulated board with permit version 2: what the library for boards makes of the guard's
// frames becomes ends, stops and session frames of this board.
#include <gtest/gtest.h>

#include "core/collision/known_answer.hpp"
#include "firmware_if/protocol/permit2_frames.hpp"
#include "hil_replay/board/permit_watch.hpp"

namespace axg {
namespace {

constexpr std::int64_t kSampleZeroUs = 1'000'000;

CanLayout layout_of_two() {
    CanLayout layout;
    layout.permit_version = 2;
    return layout;
}

/// A board that latches a sample every 1 ms, and a guard that knows its session.
struct Permit2Fixture {
    explicit Permit2Fixture(bool is_jogging = false, std::int64_t permit_us = 0)
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
    Permit2 permit(std::uint64_t sample, PermitWord word = PermitWord::run) {
        return {.word = word,
                .sync_counter = sync_counter_of(sample),
                .live_counter = ++live,
                .known_answer_signature = kKnownAnswerSignature,
                .samples = static_cast<std::uint8_t>(word == PermitWord::stop ? 0 : 3),
                .nonce = session.nonce,
                .lap = static_cast<std::uint16_t>(sample / 240)};
    }
    void send(const Permit2& permit, std::int64_t time_us) {
        for (const CanFrame& frame : encode_permit2(layout, permit, time_us)) {
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

    CanLayout layout = layout_of_two();
    PermitWatch watch;
    std::uint64_t next = 0;
    Session session{};
    int sessions = 0;
    std::uint8_t live = 0;
};

// The first pair only begins the live counter; then three in a row.
TEST(Permit2Watch, TheFirstMotionNeedsThreePermitsInARow) {
    Permit2Fixture fixture;
    fixture.run(3);
    EXPECT_EQ(fixture.watch.valid_until_us(), INT64_MIN);
    EXPECT_EQ(fixture.watch.permits(), 2U);
    EXPECT_EQ(fixture.watch.refused(), 1U);
    fixture.run(1);
    EXPECT_EQ(fixture.watch.certified_us(), kSampleZeroUs + 3000);
    EXPECT_EQ(fixture.watch.valid_until_us(), kSampleZeroUs + 6000);
}

TEST(Permit2Watch, APermitHoldsForNPeriodsFromItsSampleOverEveryLap) {
    Permit2Fixture fixture;
    fixture.run(700);
    EXPECT_EQ(fixture.watch.permits(), 699U);
    EXPECT_EQ(fixture.watch.valid_until_us(), Permit2Fixture::instant_of(699) + 3000);
    EXPECT_EQ(fixture.watch.speed_cap(), 250);
    EXPECT_FALSE(fixture.watch.is_slow());
}

TEST(Permit2Watch, AnAnswerForAnotherLapOrNonceIsNone) {
    Permit2Fixture fixture;
    fixture.run(300);
    const std::uint64_t before = fixture.watch.permits();
    fixture.latch();
    Permit2 other = fixture.permit(300);
    other.lap = 0;
    fixture.send(other, Permit2Fixture::instant_of(300) + 300);
    other = fixture.permit(300);
    other.nonce ^= 1;
    fixture.send(other, Permit2Fixture::instant_of(300) + 400);
    EXPECT_EQ(fixture.watch.permits(), before);
    fixture.send(fixture.permit(300), Permit2Fixture::instant_of(300) + 500);
    EXPECT_EQ(fixture.watch.permits(), before + 1);
}

TEST(Permit2Watch, AdviceIsThatOfTheNewestPermit) {
    Permit2Fixture fixture;
    fixture.run(9);
    fixture.latch();
    Permit2 slow = fixture.permit(9, PermitWord::slow);
    slow.cap = 60;
    slow.mask = 0xFF;
    fixture.send(slow, Permit2Fixture::instant_of(9) + 500);
    EXPECT_TRUE(fixture.watch.is_slow());
    EXPECT_EQ(fixture.watch.speed_cap(), 60);
    EXPECT_EQ(fixture.watch.valid_until_us(), Permit2Fixture::instant_of(9) + 3000);
    EXPECT_EQ(fixture.watch.ack_flags(), 0) << "this board promises no cap, so it names no permit";
}

TEST(Permit2Watch, InMotionAPermitMustComeBeforeTheLastRanOut) {
    for (const bool is_moving : {false, true}) {
        Permit2Fixture fixture;
        fixture.run(10);
        if (is_moving) {
            fixture.watch.begin(Permit2Fixture::instant_of(10) - 100);
        }
        fixture.latch_until(13);  // that of sample 9 ends with sample 12
        fixture.send(fixture.permit(12), Permit2Fixture::instant_of(12) + 500);
        EXPECT_EQ(fixture.watch.certified_us(), Permit2Fixture::instant_of(is_moving ? 9 : 12));
    }
}

// After a motion that ended by itself the next one may begin.
TEST(Permit2Watch, AtRestAPermitMayRunOut) {
    Permit2Fixture fixture;
    fixture.run(10);
    fixture.watch.begin(Permit2Fixture::instant_of(10) - 100);
    fixture.watch.rest(Permit2Fixture::instant_of(10));
    fixture.latch_until(13);
    fixture.send(fixture.permit(12), Permit2Fixture::instant_of(12) + 500);
    EXPECT_EQ(fixture.watch.certified_us(), Permit2Fixture::instant_of(12));
}

TEST(Permit2Watch, TheStopFrameAndInMotionTheWordStopItFromTheirArrival) {
    Permit2Fixture frame;
    frame.run(10);
    frame.watch.on_frame(encode_stop(frame.layout, Permit2Fixture::instant_of(9) + 600));
    frame.watch.on_frame(encode_stop(frame.layout, Permit2Fixture::instant_of(9) + 900));
    EXPECT_EQ(frame.watch.stopped_us(), Permit2Fixture::instant_of(9) + 600);
    for (const bool is_moving : {false, true}) {
        Permit2Fixture word;
        word.run(10);
        if (is_moving) {
            word.watch.begin(Permit2Fixture::instant_of(9) + 500);
        }
        word.send(word.permit(9, PermitWord::stop), Permit2Fixture::instant_of(9) + 700);
        EXPECT_EQ(word.watch.stopped_us(),
                  is_moving ? Permit2Fixture::instant_of(9) + 700 : kNever);
    }
}

TEST(Permit2Watch, AJogAndAnyOtherMotionNeedWordsOfTheirOwn) {
    for (const bool is_jogging : {false, true}) {
        for (const PermitWord word : {PermitWord::run, PermitWord::slow, PermitWord::jog}) {
            Permit2Fixture fixture(is_jogging);
            for (int i = 0; i < 6; ++i) {
                fixture.latch();
                fixture.send(fixture.permit(fixture.next - 1, word),
                             Permit2Fixture::instant_of(fixture.next - 1) + 500);
            }
            EXPECT_EQ(fixture.watch.permits(), (word == PermitWord::jog) == is_jogging ? 5U : 0U);
        }
    }
}

TEST(Permit2Watch, ABoardWithAWrongTimerBelievesAPermitForAsLongAsThatSays) {
    Permit2Fixture fixture(false, 500'000);
    fixture.run(10);
    fixture.watch.begin(Permit2Fixture::instant_of(10) - 100);
    fixture.latch_until(20);
    EXPECT_EQ(fixture.watch.valid_until_us(), Permit2Fixture::instant_of(9) + 500'000);
    EXPECT_EQ(fixture.watch.stopped_us(), kNever);
}

TEST(Permit2Watch, ASessionFrameLeavesAtOnceEvery100MsAndWithEachLap) {
    Permit2Fixture fixture;
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

TEST(Permit2Watch, AnAcknowledgedStopHasANewNonce) {
    Permit2Fixture fixture;
    fixture.run(10);
    const std::uint32_t nonce = fixture.session.nonce;
    const std::int64_t stop_us = Permit2Fixture::instant_of(9) + 600;
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
    EXPECT_EQ(fixture.watch.valid_until_us(), Permit2Fixture::instant_of(16) + 3000);
}

}  // namespace
}  // namespace axg
