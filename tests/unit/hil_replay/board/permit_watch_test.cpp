// SPDX-License-Identifier: Apache-2.0
// The board's reading of the guard, rule by rule: from both sides of each bound.
#include "hil_replay/board/permit_watch.hpp"

#include <gtest/gtest.h>

#include "core/guard/monitor.hpp"

namespace axg {
namespace {

constexpr std::int64_t kFirstLatchUs = 1'000'000;

class PermitFixture {
  public:
    PermitFixture() : watch(layout) {
        for (std::uint8_t k = 0; k < 10; ++k) {
            watch.on_latch(static_cast<std::uint8_t>(k + 1), kFirstLatchUs + 1000 * k);
        }
    }

    /// A good permit for the k-th sample, ready at `time_us`.
    Permit permit(std::uint8_t k) {
        return {PermitWord::run,
                static_cast<std::uint8_t>(k + 1),
                ++live,
                kKnownAnswerSignature,
                0,
                255,
                0};
    }
    void send(const Permit& permit, std::int64_t time_us) {
        for (const CanFrame& frame : encode_permit(layout, permit, time_us)) {
            watch.on_frame(frame);
        }
    }

    CanLayout layout;
    PermitWatch watch;
    std::uint8_t live = 0;
};

// A permit is for what the board said in its sample: a jog needs its own, and moves nothing else.
TEST(PermitWatch, AJogAndAnyOtherMotionNeedWordsOfTheirOwn) {
    for (const bool is_jogging : {false, true}) {
        for (const PermitWord word : {PermitWord::run, PermitWord::slow, PermitWord::jog}) {
            PermitFixture fixture;
            fixture.watch = PermitWatch(fixture.layout, is_jogging);
            fixture.watch.on_latch(1, kFirstLatchUs);
            Permit permit = fixture.permit(0);
            permit.word = word;
            fixture.send(permit, kFirstLatchUs + 1000);
            EXPECT_EQ(fixture.watch.permits() == 1, (word == PermitWord::jog) == is_jogging)
                << is_jogging << ' ' << static_cast<unsigned>(word);
        }
    }
}

TEST(PermitWatch, APermitHoldsForNPeriodsFromItsSample) {
    PermitFixture fixture;
    EXPECT_EQ(fixture.watch.valid_until_us(), INT64_MIN);
    fixture.send(fixture.permit(4), kFirstLatchUs + 4900);
    EXPECT_EQ(fixture.watch.certified_us(), kFirstLatchUs + 4000);
    EXPECT_EQ(fixture.watch.valid_until_us(), kFirstLatchUs + 7000);
    EXPECT_EQ(fixture.watch.permits(), 1U);
}

TEST(PermitWatch, ABoardWithAWrongTimerBelievesAPermitForAsLongAsThatSays) {
    PermitFixture fixture;
    fixture.watch = PermitWatch(fixture.layout, false, 500'000);
    fixture.watch.on_latch(5, kFirstLatchUs + 4000);
    fixture.send(fixture.permit(4), kFirstLatchUs + 4900);
    EXPECT_EQ(fixture.watch.valid_until_us(), kFirstLatchUs + 504'000);
}

TEST(PermitWatch, AnOlderSampleTakesNothingAway) {
    PermitFixture fixture;
    EXPECT_EQ(fixture.watch.speed_cap(), 0) << "no permit, no advice";
    Permit newer = fixture.permit(4);
    newer.speed_cap = 77;
    fixture.send(newer, kFirstLatchUs + 4900);
    Permit older = fixture.permit(3);
    older.speed_cap = 250;
    fixture.send(older, kFirstLatchUs + 5000);
    EXPECT_EQ(fixture.watch.valid_until_us(), kFirstLatchUs + 7000);
    EXPECT_EQ(fixture.watch.speed_cap(), 77) << "the advice of the newest sample";
}

TEST(PermitWatch, TheNewestSamplesWordSaysWhetherToBeSlow) {
    PermitFixture fixture;
    EXPECT_FALSE(fixture.watch.is_slow());
    Permit slow = fixture.permit(4);
    slow.word = PermitWord::slow;
    fixture.send(slow, kFirstLatchUs + 4900);
    EXPECT_TRUE(fixture.watch.is_slow());
    EXPECT_EQ(fixture.watch.valid_until_us(), kFirstLatchUs + 7000) << "a permit like any other";
    fixture.send(fixture.permit(3), kFirstLatchUs + 5000);
    EXPECT_TRUE(fixture.watch.is_slow()) << "an older sample's word";
    fixture.send(fixture.permit(5), kFirstLatchUs + 5900);
    EXPECT_FALSE(fixture.watch.is_slow());
}

TEST(PermitWatch, APermitThatComesAfterItsTimeIsNone) {
    for (const std::int64_t late_us : {2999, 3000}) {
        PermitFixture fixture;
        fixture.send(fixture.permit(4), kFirstLatchUs + 4000 + late_us);
        EXPECT_EQ(fixture.watch.permits(), late_us < 3000 ? 1U : 0U);
    }
}

TEST(PermitWatch, InMotionAPermitMustComeBeforeTheLastRanOut) {
    for (const bool is_moving : {false, true}) {
        for (const std::int64_t at_us : {5999, 6000}) {
            PermitFixture fixture;
            fixture.send(fixture.permit(3), kFirstLatchUs + 4000);
            if (is_moving) {
                fixture.watch.begin(kFirstLatchUs + 4500);
            }
            fixture.send(fixture.permit(5), kFirstLatchUs + at_us);
            const bool is_taken = !is_moving || at_us < 6000;
            EXPECT_EQ(fixture.watch.valid_until_us(), kFirstLatchUs + (is_taken ? 8000 : 6000));
        }
    }
}

TEST(PermitWatch, ASampleThatWasNeverSentIsNotBelieved) {
    PermitFixture fixture;
    Permit permit = fixture.permit(4);
    permit.sync_counter = 77;
    fixture.send(permit, kFirstLatchUs + 5000);
    EXPECT_EQ(fixture.watch.permits(), 0U);
    EXPECT_EQ(fixture.watch.refused(), 1U);
}

TEST(PermitWatch, AWrongSignatureIsNoPermit) {
    PermitFixture fixture;
    Permit permit = fixture.permit(4);
    permit.known_answer_signature ^= 1;
    fixture.send(permit, kFirstLatchUs + 5000);
    EXPECT_EQ(fixture.watch.permits(), 0U);
}

TEST(PermitWatch, APermitWhoseCounterStandsIsNone) {
    PermitFixture fixture;
    fixture.send(fixture.permit(4), kFirstLatchUs + 4900);
    --fixture.live;
    fixture.send(fixture.permit(5), kFirstLatchUs + 5900);
    EXPECT_EQ(fixture.watch.certified_us(), kFirstLatchUs + 4000);
}

TEST(PermitWatch, NoSingleBitGetsThrough) {
    for (std::uint32_t bit = 0; bit < 64; ++bit) {
        for (const bool is_twin : {false, true}) {
            PermitFixture fixture;
            auto pair = encode_permit(fixture.layout, fixture.permit(4), kFirstLatchUs + 5000);
            pair[is_twin ? 1 : 0].data[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
            fixture.watch.on_frame(pair[0]);
            fixture.watch.on_frame(pair[1]);
            EXPECT_EQ(fixture.watch.permits(), 0U) << "bit " << bit;
        }
    }
}

TEST(PermitWatch, ATwinLateOrAloneIsNone) {
    for (const std::int64_t late_us : {2000, 2001}) {
        PermitFixture fixture;
        auto pair = encode_permit(fixture.layout, fixture.permit(4), kFirstLatchUs + 4100);
        pair[1].time_us += late_us;
        fixture.watch.on_frame(pair[0]);
        fixture.watch.on_frame(pair[1]);
        EXPECT_EQ(fixture.watch.permits(), late_us == 2000 ? 1U : 0U);
    }
    PermitFixture fixture;
    fixture.watch.on_frame(
        encode_permit(fixture.layout, fixture.permit(4), kFirstLatchUs + 4100)[1]);
    EXPECT_EQ(fixture.watch.permits(), 0U);
}

TEST(PermitWatch, TheStopFrameAndTheStopWordStopFromTheirArrival) {
    PermitFixture frame;
    frame.send(frame.permit(4), kFirstLatchUs + 4900);
    frame.watch.on_frame(encode_stop(frame.layout, kFirstLatchUs + 5100));
    frame.watch.on_frame(encode_stop(frame.layout, kFirstLatchUs + 6100));
    EXPECT_EQ(frame.watch.stopped_us(), kFirstLatchUs + 5100);
    PermitFixture word;
    word.send(word.permit(4), kFirstLatchUs + 4900);
    Permit stop = word.permit(5);
    stop.word = PermitWord::stop;
    word.send(stop, kFirstLatchUs + 5200);
    EXPECT_EQ(word.watch.stopped_us(), kFirstLatchUs + 5200);
}

TEST(PermitWatch, BeforeTheFirstPermitTheStopWordOnlyMeansNotYet) {
    PermitFixture fixture;
    Permit stop = fixture.permit(2);
    stop.word = PermitWord::stop;
    fixture.send(stop, kFirstLatchUs + 2900);
    EXPECT_EQ(fixture.watch.stopped_us(), kNever);
    fixture.send(fixture.permit(4), kFirstLatchUs + 4900);
    EXPECT_EQ(fixture.watch.permits(), 1U);
}

}  // namespace
}  // namespace axg
