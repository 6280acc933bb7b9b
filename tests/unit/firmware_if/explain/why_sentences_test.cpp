// SPDX-License-Identifier: Apache-2.0
// What a reader is told first of a pair that was not proven: each cause has a sentence of its own,
// none names a list of the engine, and the distance follows where the stop is about one.
#include "firmware_if/explain/why_sentences.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace axg {
namespace {

WhyFacts facts_of(WhyCause cause) {
    return {.cause = cause,
            .a = "cutter (tool 1)",
            .b = "plate",
            .available_mm = 29.147,
            .needed_mm = 33.68621,
            .margin_mm = 2};
}

/// A reader takes the time of a cycle for a slow computer: the distance comes first.
TEST(WhySentences, APairNearerThanAStopNeedsIsTooNear) {
    for (const WhyCause cause : {WhyCause::capacity, WhyCause::halving}) {
        const auto sentences = why_sentences(facts_of(cause));
        ASSERT_EQ(sentences.size(), 2U);
        EXPECT_EQ(sentences[0], "cutter (tool 1) and plate are too near to be proven clear");
        EXPECT_EQ(sentences[1],
                  "they are at least 29.1470 mm apart, the proof of a stop needs up to 33.6862 mm");
    }
}

TEST(WhySentences, EachCauseHasItsOwnAndNamesBothBodies) {
    std::set<std::string> all;
    for (int i = 0; i <= static_cast<int>(WhyCause::not_proven); ++i) {
        const auto cause = static_cast<WhyCause>(i);
        WhyFacts facts = facts_of(cause);
        facts.needed_mm = 10;
        const auto sentences = why_sentences(facts);
        EXPECT_TRUE(all.insert(sentences[0]).second) << sentences[0];
        EXPECT_NE(sentences[0].find("cutter (tool 1) and plate"), std::string::npos)
            << sentences[0];
        EXPECT_EQ(sentences[0].find("list"), std::string::npos) << sentences[0];
        const bool is_about_distance = cause != WhyCause::contained && cause != WhyCause::not_known;
        EXPECT_EQ(sentences.size(), is_about_distance ? 2U : 1U) << to_text(cause);
        for (const std::string& sentence : sentences) {
            EXPECT_LE(sentence.size(), 98U) << "with its indent within 100 columns";
        }
    }
}

/// A full list stops a pair with clearance enough: no sentence calls that clearance too small.
TEST(WhySentences, ClearanceThatSufficesIsNotTheCause) {
    WhyFacts facts{.cause = WhyCause::capacity,
                   .a = "cutter",
                   .b = "plate",
                   .available_mm = 10.4689,
                   .needed_mm = 0.4555};
    EXPECT_EQ(why_sentences(facts).at(1),
              "they are at least 10.4689 mm apart, enough for a stop (0.4555 mm): the proof ran "
              "out of steps");
    facts.needed_mm = 10.4690;
    EXPECT_EQ(why_sentences(facts).at(1),
              "they are at least 10.4689 mm apart, the proof of a stop needs up to 10.4690 mm");
    facts.needed_mm = facts.available_mm = 0;
    EXPECT_EQ(why_sentences(facts).at(1),
              "no distance between them is proven, the proof of a stop needs up to 0.0000 mm");
}

TEST(WhySentences, OfAPoseTheMarginIsTheNeed) {
    WhyFacts facts = facts_of(WhyCause::margin);
    facts.is_of_stop = false;
    EXPECT_EQ(why_sentences(facts)[1], "they are at least 29.1470 mm apart, their margin is 2 mm");
}

TEST(WhySentences, NothingIsClaimedOfADistanceThatIsNotProven) {
    WhyFacts facts = facts_of(WhyCause::reach);
    facts.available_mm = 0;
    EXPECT_EQ(why_sentences(facts)[1],
              "no distance between them is proven, the proof of a stop needs up to 33.6862 mm");
}

TEST(StopSentences, AnUnknownToolNamesTheFileAndWhatLeadsOut) {
    StopAccount account;
    account.cause = GuardFault::verdict;
    account.reason = StopReason::tool;
    account.file = "mill.yaml";
    account.unknown_tool = 3;
    EXPECT_EQ(stop_sentences(account),
              (std::vector<std::string>{"stopped: verdict: tool",
                                        "tool 3 is not in mill.yaml: add it under tools; load "
                                        "another tool to go on"}));
    account.unknown_tool.reset();
    EXPECT_EQ(stop_sentences(account).size(), 1U) << "a known tool was loaded since";
}

TEST(StopSentences, OfAPairComeLineDistancesAndTheWayOut) {
    StopAccount account;
    account.cause = GuardFault::verdict;
    account.reason = StopReason::predicted;
    account.a = "cutter";
    account.b = "plate";
    account.program_line = 4;
    account.why = facts_of(WhyCause::not_proven);
    account.ways_out = "jog Z+ (1 mm: clearance at least 2.5000 mm)";
    const auto sentences = stop_sentences(account);
    ASSERT_EQ(sentences.size(), 4U);
    EXPECT_EQ(sentences[0], "stopped: verdict: predicted: cutter - plate, program line 4");
    EXPECT_EQ(sentences[1], "cutter (tool 1) and plate could not be proven clear");
    EXPECT_EQ(sentences[2],
              "they are at least 29.1470 mm apart, the proof of a stop needs up to 33.6862 mm");
    EXPECT_EQ(sentences[3], account.ways_out);
}

TEST(StopSentences, OnlyWhatBelongsToTheCauseIsNamed) {
    StopAccount account;
    account.cause = GuardFault::verdict;
    account.reason = StopReason::predicted;
    account.a = "cutter";
    account.b = "c";
    EXPECT_EQ(stop_sentences(account)[0], "stopped: verdict: predicted: cutter - c");
    account = {};
    account.cause = GuardFault::input;
    account.detail = "stale (no frame in time)";
    EXPECT_EQ(stop_sentences(account)[0], "stopped: input: stale (no frame in time)");
    account = {};
    account.cause = GuardFault::silence;
    EXPECT_EQ(stop_sentences(account)[0], "stopped: silence");
}

}  // namespace
}  // namespace axg
