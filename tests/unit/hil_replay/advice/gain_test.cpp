// SPDX-License-Identifier: Apache-2.0
// Only what gains is advised: a stop of the same pair half a millimetre nearer, or none; the best
// first. All else that ran is counted.
#include "hil_replay/advice/gain.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace axg::test {
namespace {

RunEnd stopped(std::uint32_t pair, double left_mm) {
    return {.is_stopped = true, .is_complete = true, .pair = pair, .left_mm = left_mm};
}

/// At a later sample of the trace.
RunEnd later(std::uint32_t pair, double left_mm) {
    RunEnd end = stopped(pair, left_mm);
    end.snapshot.arrived_us = 1000;
    return end;
}

/// The advice after one more run of a stop of pair 3 with 10 mm left.
Advice after(const RunEnd& again) {
    Advice out;
    note_end({.lines = {"guard: {free_jerk: limited}"}}, true, stopped(3, 10), again, out);
    EXPECT_EQ(out.tried, 1U);
    return out;
}

TEST(Gain, IsAdvisedFromHalfAMillimetreOn) {
    EXPECT_TRUE(after(stopped(3, 9.51)).settings.empty());
    EXPECT_TRUE(after(stopped(3, 12)).settings.empty()) << "farther";
    const Advice advice = after(stopped(3, 9.5));
    ASSERT_EQ(advice.settings.size(), 1U);
    EXPECT_DOUBLE_EQ(advice.settings[0].gain_mm, 0.5);
    EXPECT_DOUBLE_EQ(advice.settings[0].left_mm, 9.5);
    EXPECT_TRUE(advice.settings[0].is_driven);
    EXPECT_FALSE(advice.settings[0].is_gone);
}

TEST(Gain, OfAnotherPairsStopIsNone) {
    EXPECT_TRUE(after(stopped(4, 0.1)).settings.empty());
    EXPECT_TRUE(after(stopped(kNoIndex, 0)).settings.empty()) << "a broken limit";
}

TEST(Gain, OfARunWithoutAStopNeedsARunWithoutAFault) {
    const Advice advice = after({.is_complete = true, .ended_us = 2'500'000});
    ASSERT_EQ(advice.settings.size(), 1U);
    EXPECT_TRUE(advice.settings[0].is_gone);
    EXPECT_DOUBLE_EQ(advice.settings[0].after_s, 2.5);
    EXPECT_TRUE(after({.is_complete = false}).settings.empty());
}

// Another limit may certify less of the same place.
TEST(Gain, OnATraceIsAtALaterSample) {
    Advice advice;
    note_end({.lines = {"a"}}, false, stopped(3, 10), stopped(3, 8), advice);
    EXPECT_TRUE(advice.settings.empty());
    note_end({.lines = {"a"}}, false, stopped(3, 10), later(3, 8), advice);
    EXPECT_EQ(advice.settings.size(), 1U);
}

TEST(Gain, OfFewerLinesReplacesThatOfMore) {
    Advice advice;
    const RunEnd first = stopped(3, 10);
    note_end({.lines = {"a", "b"}}, true, first, stopped(3, 8), advice);
    note_end({.lines = {"b"}}, true, first, stopped(3, 8.005), advice);
    note_end({.lines = {"b", "c"}}, true, first, stopped(3, 7), advice);
    sort_settings(advice);
    ASSERT_EQ(advice.settings.size(), 2U);
    EXPECT_EQ(advice.settings[0].lines.size(), 2U) << "b and c gain more";
    EXPECT_EQ(advice.settings[1].lines, std::vector<std::string>{"b"});
}

TEST(Gain, SortsTheBestFirst) {
    Advice advice;
    const RunEnd first = stopped(3, 10);
    note_end({.lines = {"a"}}, true, first, stopped(3, 8), advice);
    note_end({.lines = {"b"}}, true, first, {.is_complete = true}, advice);
    note_end({.lines = {"c"}}, false, first, later(3, 1), advice);
    note_end({.lines = {"d"}}, false, first, later(3, 8), advice);
    sort_settings(advice);
    std::string order;
    for (const AdvisedSetting& setting : advice.settings) {
        order += setting.lines[0];
    }
    EXPECT_EQ(order, "bcad");
}

}  // namespace
}  // namespace axg::test
