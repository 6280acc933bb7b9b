// SPDX-License-Identifier: Apache-2.0
// The board's reading of the guard, rule by rule: from both sides of each bound.
#include "hil_replay/board/permit_watch.hpp"

#include <gtest/gtest.h>

#include "core/guard/monitor.hpp"

namespace axg {
namespace {

constexpr std::int64_t kStart = 1'000'000;

class Bench {
  public:
    Bench() : watch(layout) {
        for (std::uint8_t k = 0; k < 10; ++k) {
            watch.on_latch(static_cast<std::uint8_t>(k + 1), kStart + 1000 * k);
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
            Bench bench;
            bench.watch = PermitWatch(bench.layout, is_jogging);
            bench.watch.on_latch(1, kStart);
            Permit permit = bench.permit(0);
            permit.word = word;
            bench.send(permit, kStart + 1000);
            EXPECT_EQ(bench.watch.permits() == 1, (word == PermitWord::jog) == is_jogging)
                << is_jogging << ' ' << static_cast<unsigned>(word);
        }
    }
}

TEST(PermitWatch, APermitHoldsForNPeriodsFromItsSample) {
    Bench bench;
    EXPECT_EQ(bench.watch.valid_until_us(), INT64_MIN);
    bench.send(bench.permit(4), kStart + 4900);
    EXPECT_EQ(bench.watch.certified_us(), kStart + 4000);
    EXPECT_EQ(bench.watch.valid_until_us(), kStart + 7000);
    EXPECT_EQ(bench.watch.permits(), 1U);
}

TEST(PermitWatch, AnOlderSampleTakesNothingAway) {
    Bench bench;
    EXPECT_EQ(bench.watch.speed_cap(), 0) << "no permit, no advice";
    Permit newer = bench.permit(4);
    newer.speed_cap = 77;
    bench.send(newer, kStart + 4900);
    Permit older = bench.permit(3);
    older.speed_cap = 250;
    bench.send(older, kStart + 5000);
    EXPECT_EQ(bench.watch.valid_until_us(), kStart + 7000);
    EXPECT_EQ(bench.watch.speed_cap(), 77) << "the advice of the newest sample";
}

TEST(PermitWatch, TheNewestSamplesWordSaysWhetherToBeSlow) {
    Bench bench;
    EXPECT_FALSE(bench.watch.is_slow());
    Permit slow = bench.permit(4);
    slow.word = PermitWord::slow;
    bench.send(slow, kStart + 4900);
    EXPECT_TRUE(bench.watch.is_slow());
    EXPECT_EQ(bench.watch.valid_until_us(), kStart + 7000) << "a permit like any other";
    bench.send(bench.permit(3), kStart + 5000);
    EXPECT_TRUE(bench.watch.is_slow()) << "an older sample's word";
    bench.send(bench.permit(5), kStart + 5900);
    EXPECT_FALSE(bench.watch.is_slow());
}

TEST(PermitWatch, APermitThatComesAfterItsTimeIsNone) {
    for (const std::int64_t late_us : {2999, 3000}) {
        Bench bench;
        bench.send(bench.permit(4), kStart + 4000 + late_us);
        EXPECT_EQ(bench.watch.permits(), late_us < 3000 ? 1U : 0U);
    }
}

TEST(PermitWatch, InMotionAPermitMustComeBeforeTheLastRanOut) {
    for (const bool is_moving : {false, true}) {
        for (const std::int64_t at_us : {5999, 6000}) {
            Bench bench;
            bench.send(bench.permit(3), kStart + 4000);
            if (is_moving) {
                bench.watch.begin();
            }
            bench.send(bench.permit(5), kStart + at_us);
            const bool is_taken = !is_moving || at_us < 6000;
            EXPECT_EQ(bench.watch.valid_until_us(), kStart + (is_taken ? 8000 : 6000));
        }
    }
}

TEST(PermitWatch, ASampleThatWasNeverSentIsNotBelieved) {
    Bench bench;
    Permit permit = bench.permit(4);
    permit.sync_counter = 77;
    bench.send(permit, kStart + 5000);
    EXPECT_EQ(bench.watch.permits(), 0U);
    EXPECT_EQ(bench.watch.refused(), 1U);
}

TEST(PermitWatch, AWrongSignatureIsNoPermit) {
    Bench bench;
    Permit permit = bench.permit(4);
    permit.known_answer_signature ^= 1;
    bench.send(permit, kStart + 5000);
    EXPECT_EQ(bench.watch.permits(), 0U);
}

TEST(PermitWatch, APermitWhoseCounterStandsIsNone) {
    Bench bench;
    bench.send(bench.permit(4), kStart + 4900);
    --bench.live;
    bench.send(bench.permit(5), kStart + 5900);
    EXPECT_EQ(bench.watch.certified_us(), kStart + 4000);
}

TEST(PermitWatch, NoSingleBitGetsThrough) {
    for (std::uint32_t bit = 0; bit < 64; ++bit) {
        for (const bool is_twin : {false, true}) {
            Bench bench;
            auto pair = encode_permit(bench.layout, bench.permit(4), kStart + 5000);
            pair[is_twin ? 1 : 0].data[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
            bench.watch.on_frame(pair[0]);
            bench.watch.on_frame(pair[1]);
            EXPECT_EQ(bench.watch.permits(), 0U) << "bit " << bit;
        }
    }
}

TEST(PermitWatch, ATwinLateOrAloneIsNone) {
    for (const std::int64_t late_us : {2000, 2001}) {
        Bench bench;
        auto pair = encode_permit(bench.layout, bench.permit(4), kStart + 4100);
        pair[1].time_us += late_us;
        bench.watch.on_frame(pair[0]);
        bench.watch.on_frame(pair[1]);
        EXPECT_EQ(bench.watch.permits(), late_us == 2000 ? 1U : 0U);
    }
    Bench bench;
    bench.watch.on_frame(encode_permit(bench.layout, bench.permit(4), kStart + 4100)[1]);
    EXPECT_EQ(bench.watch.permits(), 0U);
}

TEST(PermitWatch, TheStopFrameAndTheStopWordStopFromTheirArrival) {
    Bench frame;
    frame.send(frame.permit(4), kStart + 4900);
    frame.watch.on_frame(encode_stop(frame.layout, kStart + 5100));
    frame.watch.on_frame(encode_stop(frame.layout, kStart + 6100));
    EXPECT_EQ(frame.watch.stopped_us(), kStart + 5100);
    Bench word;
    word.send(word.permit(4), kStart + 4900);
    Permit stop = word.permit(5);
    stop.word = PermitWord::stop;
    word.send(stop, kStart + 5200);
    EXPECT_EQ(word.watch.stopped_us(), kStart + 5200);
}

TEST(PermitWatch, BeforeTheFirstPermitTheStopWordOnlyMeansNotYet) {
    Bench bench;
    Permit stop = bench.permit(2);
    stop.word = PermitWord::stop;
    bench.send(stop, kStart + 2900);
    EXPECT_EQ(bench.watch.stopped_us(), kNever);
    bench.send(bench.permit(4), kStart + 4900);
    EXPECT_EQ(bench.watch.permits(), 1U);
}

}  // namespace
}  // namespace axg
