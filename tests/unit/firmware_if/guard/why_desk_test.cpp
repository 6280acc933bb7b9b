// SPDX-License-Identifier: Apache-2.0
// What the live guard shows of a real cycle that was not proven: the distances that a replay of the
// same cycle reports, for the stop in force and for the permit withheld now, and for no other.
#include "firmware_if/guard/why_desk.hpp"

#include <gtest/gtest.h>

#include <array>

#include "firmware_if/live/status_line.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "tests/support/descending_chain.hpp"
#include "tests/support/json_value.hpp"

namespace axg {
namespace {

using test::DescendingChain;

test::Json line_of(const Machine& machine, const GuardWhy& why, const LiveView& view) {
    const StatusLine line(machine, "m.yaml", "can0", "stoppable", "0");
    std::array<char, kStatusLineBytesMax> text{};
    const std::size_t size =
        line.write(&view, {{{}, why.stop}, why.withheld, {}}, view.time_us, text);
    return test::Json::parse(std::string(text.data(), size));
}

/// As a replay asks about it.
StopWhy offline(DescendingChain& chain) {
    const RefusedCycle& refused = chain.refused;
    const auto why = why_of({chain.paper.loaded, chain.paper.engine->engine()},
                            {refused.reason, refused.pair, refused.snapshot, refused.unproven});
    EXPECT_TRUE(why);
    return why.value_or(StopWhy{});
}

LiveView stopped_by(const LiveResult& result) {
    LiveView view;
    view.phase = GuardPhase::stopped;
    view.cause = GuardFault::verdict;
    view.reason = result.result.reason;
    view.pair = result.result.pair;
    view.stop_query = result.number;
    return view;
}

void expect_same(const test::Json& has, const StopWhy& expected) {
    constexpr double kDigitsMm = 0.51e-4;  // four are written
    ASSERT_TRUE(has.is_object());
    const DistanceNeed& need = expected.need;
    for (const auto& [part, value_mm] : {std::pair{"needed_mm", need.sum_mm()},
                                         {"available_mm", expected.available_mm},
                                         {"within_mm", expected.within_mm},
                                         {"until_braking_mm", need.until_braking_mm},
                                         {"braking_mm", need.braking_mm},
                                         {"position_error_mm", need.position_error_mm},
                                         {"speed_uncertainty_mm", need.speed_uncertainty_mm},
                                         {"margin_mm", need.margin_mm},
                                         {"arithmetic_mm", need.arithmetic_mm}}) {
        ASSERT_TRUE(has[part].is_number()) << part;
        EXPECT_NEAR(has[part].get<double>(), value_mm, kDigitsMm) << part;
    }
    EXPECT_TRUE(has["to_standstill_mm"].is_null());
    EXPECT_EQ(has["list_full"], expected.is_list_full);
    ASSERT_EQ(has["open"].is_object(), expected.open.has_value());
    if (expected.open) {
        EXPECT_NEAR(has["open"]["needed_mm"].get<double>(), expected.open->needed_mm, kDigitsMm);
        EXPECT_NEAR(has["open"]["available_mm"].get<double>(), expected.open->available_mm,
                    kDigitsMm);
    }
}

// The stop is one cycle, the permit withheld another, nearer one, whose reach was halved.
TEST(WhyDesk, TheLineHasTheDistancesOfTheReplay) {
    DescendingChain chain(true);
    chain.descend();
    ASSERT_TRUE(chain.result.result.is_stop);
    LiveView view = stopped_by(chain.result);
    const StopWhy stop = offline(chain);
    const auto is_halved = [&chain] {
        return open_part(chain.machine(), chain.paper.engine->engine(), chain.refused.unproven)
            .has_value();
    };
    for (int i = 0; i < 1000 && (i < 20 || !is_halved()); ++i) {
        chain.step(true);
    }
    ASSERT_TRUE(is_halved());
    view.withheld = chain.withheld();
    const GuardWhy why = chain.desk.why(view.stop_query, view.withheld);
    const test::Json said = line_of(chain.machine(), why, view);
    expect_same(said["why"], stop);
    const StopWhy withheld = offline(chain);
    expect_same(said["withheld_why"], withheld);
    EXPECT_GT(stop.need.braking_mm, 0.1) << "it moves";
    EXPECT_GT(stop.available_mm, 0);
    EXPECT_LT(withheld.available_mm, stop.available_mm);
}

TEST(WhyDesk, InContactModeMarginAndArithmeticAreAllOfTheNeed) {
    DescendingChain chain(false);
    chain.descend();
    ASSERT_EQ(chain.result.result.reason, StopReason::contact);
    const LiveView view = stopped_by(chain.result);
    const GuardWhy why = chain.desk.why(view.stop_query, view.withheld);
    const test::Json has = line_of(chain.machine(), why, view)["why"];
    ASSERT_TRUE(has.is_object());
    const StopWhy expected = offline(chain);
    EXPECT_NEAR(has["needed_mm"].get<double>(), expected.need.sum_mm(), 1e-4);
    EXPECT_NEAR(has["available_mm"].get<double>(), expected.available_mm, 1e-4);
    EXPECT_TRUE(has["braking_mm"].is_null()) << "no motion is looked at";
    EXPECT_TRUE(has["to_standstill_mm"].is_null());
}

// The axes are jogged away, and near something else, while the stop is in force.
TEST(WhyDesk, TheStopInForceStays) {
    DescendingChain chain(true);
    chain.descend();
    const std::uint32_t stop = chain.result.number;
    const double needed_mm = offline(chain).need.sum_mm();
    chain.step(true);  // submitted before the bus thread had the stop
    chain.desk.set_stop(stop);
    chain.change_step(0, false);
    chain.rest();
    chain.change_step(-0.1, false);
    for (int i = 0; i < 200; ++i) {
        chain.step(false);
    }
    ASSERT_TRUE(chain.result.result.has_permit);
    chain.change_step(0.12, false);
    for (int i = 0; i < 200 && !chain.result.result.is_stop; ++i) {
        chain.step(true);
    }
    ASSERT_EQ(chain.result.result.reason, StopReason::predicted);
    const GuardWhy why = chain.desk.why(stop, chain.withheld());
    ASSERT_TRUE(why.stop);
    EXPECT_DOUBLE_EQ(why.stop->distances.need.sum_mm(), needed_mm);
    ASSERT_TRUE(why.withheld);
    EXPECT_NE(why.withheld->distances.need.sum_mm(), needed_mm) << "faster by now";
    EXPECT_FALSE(chain.desk.why(0, {}).stop);
    EXPECT_FALSE(chain.desk.why(stop + 1, {}).stop) << "a stop that it has no copy of";

    // After the reset the next one counts, though the cycle before it was a stop too.
    chain.desk.set_stop(0);
    ++chain.epoch;
    chain.step(true);
    ASSERT_TRUE(chain.result.result.is_stop);
    EXPECT_TRUE(chain.desk.why(chain.result.number, {}).stop);
}

TEST(WhyDesk, AWithheldPermitIsThatOfNowOrNotKnown) {
    DescendingChain chain(true);
    chain.descend();
    const WithheldPermit now = chain.withheld();
    EXPECT_TRUE(chain.desk.why(0, now).withheld);
    WithheldPermit other = now;
    other.pair = now.pair == 0 ? 1 : 0;
    EXPECT_FALSE(chain.desk.why(0, other).withheld);
    other = now;
    other.reason = StopReason::contained;
    EXPECT_FALSE(chain.desk.why(0, other).withheld);
    other = now;
    other.query = now.query + 1;
    EXPECT_FALSE(chain.desk.why(0, other).withheld) << "the copy is older than that";
    other.query = now.query - 1;
    EXPECT_TRUE(chain.desk.why(0, other).withheld) << "a newer one about the same pair";
    other = now;
    other.why = WithheldPermit::Why::late;
    EXPECT_FALSE(chain.desk.why(0, other).withheld);
}

TEST(WhyDesk, WhatIsNoMatterOfDistanceHasNone) {
    DescendingChain chain(true);
    chain.descend();
    const Engine engine = chain.paper.engine->engine();
    const auto room = std::make_unique<PairQueries>();
    const auto has = [&](const RefusedCycle& cycle) {
        return pair_why(chain.machine(), engine, cycle, *room).has_value();
    };
    EXPECT_TRUE(has(chain.refused));
    EXPECT_FALSE(pair_why(chain.machine(), {}, chain.refused, *room)) << "no engine for it";
    for (const StopReason reason : {StopReason::contained, StopReason::left_limits,
                                    StopReason::tool, StopReason::none, StopReason::engine}) {
        RefusedCycle cycle = chain.refused;
        cycle.reason = reason;
        EXPECT_FALSE(has(cycle)) << to_text(reason);
    }
    RefusedCycle cycle = chain.refused;
    cycle.unproven.is_blind = true;
    EXPECT_FALSE(has(cycle)) << "nothing was queried";
    cycle = chain.refused;
    cycle.unproven.is_known = false;
    EXPECT_FALSE(has(cycle)) << "of a prediction the pose alone tells nothing";
    cycle = chain.refused;
    cycle.pair = kNoIndex;
    EXPECT_FALSE(has(cycle));
}

}  // namespace
}  // namespace axg
