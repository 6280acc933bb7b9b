// SPDX-License-Identifier: Apache-2.0
// One cycle's decision: what gives a permit, what stops and under which name, and that a stop stays
// until a person clears it.
#include "core/guard/monitor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace axg {
namespace {

QueryResult far_result() {
    QueryResult a;
    a.status = QueryStatus::ok;
    a.proof = Proof::far;
    return a;
}

QueryResult near_result() {
    QueryResult a;
    a.status = QueryStatus::ok;
    return a;
}

/// Three pairs (7, 3, 9 of the machine), all proven, known-answer test passed.
struct Cycle {
    PairQueries pair_queries;
    std::vector<QueryResult> query_results{far_result(), far_result(), far_result(), far_result(),
                                           near_result()};
    std::vector<ContainmentResult> containment_results =
        std::vector<ContainmentResult>(3, {QueryStatus::ok, Containment::none});
    MonitorState state;

    Cycle() {
        pair_queries.status = SnapshotStatus::ok;
        pair_queries.count = 3;
        pair_queries.pair[0] = 7;
        pair_queries.pair[1] = 3;
        pair_queries.pair[2] = 9;
    }
    CycleResult step(bool ready = true) {
        return axg::step(state, pair_queries, query_results, containment_results, ready);
    }
};

TEST(Monitor, GivesAPermitWhenEverythingIsProven) {
    Cycle cycle;
    const CycleResult result = cycle.step();
    EXPECT_TRUE(result.has_permit);
    EXPECT_FALSE(result.stops_now);
    EXPECT_EQ(result.reason, StopReason::none);
    EXPECT_EQ(result.pair, kNoIndex);
    EXPECT_EQ(result.not_proven, 0U);
    EXPECT_EQ(result.known_answer_signature, kKnownAnswerSignature);
    EXPECT_EQ(cycle.state.permits, 1U);
    EXPECT_EQ(cycle.state.cycles, 1U);
    EXPECT_EQ(cycle.state.live_counter, 1U);
}

TEST(Monitor, ZeroedMemoryHasNoPermit) {
    EXPECT_FALSE(CycleResult{}.has_permit);
    Cycle cycle;
    cycle.query_results.assign(5, QueryResult{});
    const CycleResult result = cycle.step();
    EXPECT_FALSE(result.has_permit);
    EXPECT_EQ(result.reason, StopReason::engine);
    EXPECT_EQ(result.known_answer_signature, 0);
    MonitorState state;
    EXPECT_FALSE(axg::step(state, PairQueries{}, {}, {}, true).has_permit);
    EXPECT_EQ(state.reason, StopReason::engine);
}

TEST(Monitor, GivesNoPermitUnlessTheReceiverIsReadyAndDoesNotStopForIt) {
    Cycle cycle;
    const CycleResult early = cycle.step(false);
    EXPECT_FALSE(early.has_permit);
    EXPECT_FALSE(early.stops_now);
    EXPECT_FALSE(cycle.state.is_stopped);
    EXPECT_TRUE(cycle.step(true).has_permit);
}

struct Fault {
    const char* name;
    QueryStatus status;
    Proof proof;
    StopReason reason;
};

class MonitorResult : public testing::TestWithParam<Fault> {};

TEST_P(MonitorResult, StopsUnderItsName) {
    for (std::size_t at = 0; at < 3; ++at) {
        Cycle cycle;
        cycle.query_results[at].status = GetParam().status;
        cycle.query_results[at].proof = GetParam().proof;
        const CycleResult result = cycle.step();
        EXPECT_FALSE(result.has_permit);
        EXPECT_TRUE(result.stops_now);
        EXPECT_EQ(result.reason, GetParam().reason);
        EXPECT_EQ(result.pair, cycle.pair_queries.pair[at]);
        EXPECT_EQ(result.not_proven, 1U);
        EXPECT_EQ(cycle.state.pair, cycle.pair_queries.pair[at]);
        EXPECT_EQ(cycle.state.permits, 0U);
    }
}

// A proof beside a status that is not ok is worth nothing.
INSTANTIATE_TEST_SUITE_P(
    Statuses, MonitorResult,
    testing::Values(
        Fault{"near", QueryStatus::ok, Proof::not_proven, StopReason::contact},
        Fault{"not_run", QueryStatus::not_run, Proof::far, StopReason::engine},
        Fault{"bad_question", QueryStatus::bad_query, Proof::far, StopReason::engine},
        Fault{"nodes", QueryStatus::too_many_node_pairs, Proof::far, StopReason::capacity},
        Fault{"triangles", QueryStatus::too_many_triangle_pairs, Proof::far, StopReason::capacity},
        Fault{"rechecks", QueryStatus::too_many_rechecks, Proof::far, StopReason::capacity}),
    [](const auto& fault) { return std::string(fault.param.name); });

// Surfaces proven apart are not enough: one body may be inside the other.
TEST(Monitor, ABodyInsideAnotherStopsUnderItsName) {
    struct Case {
        ContainmentResult query_result;
        StopReason reason;
    };
    for (const Case& wrong :
         {Case{{QueryStatus::ok, Containment::a_in_b}, StopReason::contained},
          Case{{QueryStatus::ok, Containment::b_in_a}, StopReason::contained},
          Case{{QueryStatus::ok, Containment::not_proven}, StopReason::contained},
          Case{{QueryStatus::not_run, Containment::none}, StopReason::engine},
          Case{{QueryStatus::bad_query, Containment::none}, StopReason::engine},
          Case{{QueryStatus::bad_rounding, Containment::none}, StopReason::engine},
          Case{{QueryStatus::too_many_node_pairs, Containment::none}, StopReason::capacity},
          Case{{QueryStatus::too_many_triangle_pairs, Containment::none}, StopReason::capacity},
          Case{{QueryStatus::too_many_rechecks, Containment::none}, StopReason::capacity}}) {
        for (std::size_t at = 0; at < 3; ++at) {
            Cycle cycle;
            cycle.containment_results[at] = wrong.query_result;
            const CycleResult result = cycle.step();
            EXPECT_FALSE(result.has_permit);
            EXPECT_TRUE(result.stops_now);
            EXPECT_EQ(result.reason, wrong.reason);
            EXPECT_EQ(result.pair, cycle.pair_queries.pair[at]);
            EXPECT_EQ(result.not_proven, 1U);
            EXPECT_EQ(result.known_answer_signature, kKnownAnswerSignature);
        }
    }
}

TEST(Monitor, AContactIsNamedBeforeWhatIsNotQueriedThen) {
    Cycle cycle;
    cycle.query_results[1] = near_result();
    cycle.containment_results[1] = ContainmentResult{};
    EXPECT_EQ(cycle.step().reason, StopReason::contact);
}

TEST(Monitor, TheFirstPairInOrderNamesTheStop) {
    Cycle cycle;
    cycle.query_results[1] = near_result();
    cycle.query_results[2].status = QueryStatus::too_many_rechecks;
    const CycleResult result = cycle.step();
    EXPECT_EQ(result.pair, 3U);
    EXPECT_EQ(result.reason, StopReason::contact);
    EXPECT_EQ(result.not_proven, 2U);
}

TEST(Monitor, AWrongKnownAnswerStopsWhicheverHalfIsWrong) {
    const auto after = [](std::size_t at, const QueryResult& query_result) {
        Cycle cycle;
        cycle.query_results[at] = query_result;
        return cycle.step();
    };
    QueryResult full, not_run;
    full.status = QueryStatus::too_many_node_pairs;
    for (const CycleResult& result : {after(3, near_result()), after(3, full), after(3, not_run),
                                      after(4, far_result()), after(4, not_run)}) {
        EXPECT_FALSE(result.has_permit);
        EXPECT_EQ(result.reason, StopReason::known_answer);
        EXPECT_EQ(result.known_answer_signature, 0);
        EXPECT_EQ(result.pair, kNoIndex);
    }
    // The known-near query touches: a full list may leave it out, as long as it is not called
    // far.
    EXPECT_TRUE(after(4, full).has_permit);
}

TEST(Monitor, AnEngineThatAlwaysSaysTheSameIsFoundOutWithoutAnyPair) {
    for (const QueryResult& always : {far_result(), near_result()}) {
        Cycle cycle;
        cycle.pair_queries.count = 0;
        cycle.containment_results.clear();
        cycle.query_results.assign(2, always);
        EXPECT_EQ(cycle.step().reason, StopReason::known_answer);
    }
}

TEST(Monitor, ASnapshotThatFailedStopsUnderItsName) {
    for (const auto& [status, reason] : {std::pair{SnapshotStatus::unknown_tool, StopReason::tool},
                                         {SnapshotStatus::wrong_axes, StopReason::snapshot},
                                         {SnapshotStatus::not_finite, StopReason::snapshot},
                                         {SnapshotStatus::not_run, StopReason::engine}}) {
        MonitorState state;
        PairQueries pair_queries;
        pair_queries.status = status;
        const CycleResult result = step(state, pair_queries, {}, {}, true);
        EXPECT_FALSE(result.has_permit);
        EXPECT_TRUE(result.stops_now);
        EXPECT_EQ(result.reason, reason);
        EXPECT_EQ(result.known_answer_signature, 0);
    }
}

TEST(Monitor, AStopStaysAndIsAnnouncedOnceAndKeepsItsFirstCause) {
    Cycle cycle;
    cycle.query_results[1] = near_result();
    EXPECT_TRUE(cycle.step().stops_now);
    cycle.query_results[1] = far_result();
    for (int i = 0; i < 300; ++i) {  // beyond the wrap of the live counter
        const CycleResult result = cycle.step();
        ASSERT_FALSE(result.has_permit);
        ASSERT_FALSE(result.stops_now);
        ASSERT_EQ(result.reason, StopReason::none) << "the cycle itself proved everything";
    }
    cycle.query_results[0].status = QueryStatus::too_many_node_pairs;
    EXPECT_FALSE(cycle.step().stops_now);
    EXPECT_EQ(cycle.state.reason, StopReason::contact);
    EXPECT_EQ(cycle.state.pair, 3U);
    EXPECT_EQ(cycle.state.permits, 0U);
    EXPECT_EQ(cycle.state.cycles, 302U);
    EXPECT_EQ(cycle.state.live_counter, static_cast<std::uint8_t>(302));
}

TEST(Monitor, OnlyAResetClearsAStop) {
    Cycle cycle;
    cycle.query_results[0] = near_result();
    (void)cycle.step();
    cycle.query_results[0] = far_result();
    EXPECT_FALSE(cycle.step().has_permit);
    reset(cycle.state);
    EXPECT_EQ(cycle.state.reason, StopReason::none);
    EXPECT_EQ(cycle.state.pair, kNoIndex);
    EXPECT_TRUE(cycle.step().has_permit);
    cycle.query_results[2] = near_result();
    EXPECT_TRUE(cycle.step().stops_now) << "a second stop is announced too";
    EXPECT_EQ(cycle.state.pair, 9U);
}

TEST(Monitor, EveryReasonHasAWordOfItsOwn) {
    std::vector<std::string> words;
    for (int i = 0; i <= static_cast<int>(StopReason::input); ++i) {
        const std::string word = to_text(static_cast<StopReason>(i));
        EXPECT_NE(word, "unknown");
        for (const std::string& other : words) {
            EXPECT_NE(word, other);
        }
        words.push_back(word);
    }
    EXPECT_STREQ(to_text(static_cast<StopReason>(200)), "unknown");
}

TEST(MonitorDeathTest, ResultsThatDoNotFitTheQueriesStopTheProgram) {
    Cycle cycle;
    cycle.query_results.pop_back();
    EXPECT_DEATH((void)cycle.step(), "");
    Cycle other;
    other.containment_results.pop_back();
    EXPECT_DEATH((void)other.step(), "");
}

/// A certificate of two pairs (7 and 3 of the machine), proven, known-answer test passed.
struct StopCase {
    std::vector<PairProof> proofs{proven(7), proven(3)};
    StopCycle cycle{.status = SnapshotStatus::ok,
                    .known_answer_signature = kKnownAnswerSignature,
                    .is_settled = true};
    MonitorState state;

    static PairProof proven(std::uint32_t pair) {
        PairProof proof;
        proof.pair = pair;
        proof.surfaces.proof = JointBoxProof::proven;
        proof.surfaces.status = QueryStatus::ok;
        proof.containment_result = {QueryStatus::ok, Containment::none};
        return proof;
    }
    CycleResult step(bool ready = true, bool is_armed = true) {
        cycle.proofs = proofs;
        return axg::step(state, cycle, ready, is_armed);
    }
};

TEST(MonitorStoppable, GivesAPermitWhenEverythingIsProvenToStandstill) {
    StopCase stop;
    const CycleResult result = stop.step();
    EXPECT_TRUE(result.has_permit);
    EXPECT_EQ(result.reason, StopReason::none);
    EXPECT_EQ(result.not_proven, 0U);
    EXPECT_EQ(result.known_answer_signature, kKnownAnswerSignature);
    EXPECT_TRUE(stop.state.was_permitted);
    EXPECT_FALSE(stop.step(false).has_permit) << "not without a receiver that trusts its pictures";
    EXPECT_FALSE(stop.state.is_stopped);
}

TEST(MonitorStoppable, ZeroedMemoryHasNoPermit) {
    MonitorState state;
    EXPECT_FALSE(axg::step(state, StopCycle{}, true).has_permit);
    EXPECT_EQ(state.reason, StopReason::engine);
    StopCase stop;
    stop.proofs[1] = PairProof{};
    EXPECT_EQ(stop.step().reason, StopReason::engine);
}

TEST(MonitorStoppable, WhatIsNotProvenStopsUnderItsName) {
    const auto reason_with = [](auto&& breaks) {
        StopCase stop;
        EXPECT_TRUE(stop.step().has_permit);
        breaks(stop);
        const CycleResult result = stop.step();
        EXPECT_TRUE(result.stops_now);
        EXPECT_FALSE(result.has_permit);
        EXPECT_FALSE(stop.step().stops_now) << "once";
        return std::pair{result.reason, result.pair};
    };
    using Named = std::pair<StopReason, std::uint32_t>;
    const auto surfaces = [&](JointBoxProof proof) {
        return reason_with([proof](StopCase& stop) { stop.proofs[1].surfaces.proof = proof; });
    };
    EXPECT_EQ(surfaces(JointBoxProof::budget_spent), (Named{StopReason::predicted, 3}));
    EXPECT_EQ(surfaces(JointBoxProof::engine_failed), (Named{StopReason::engine, 3}));
    EXPECT_EQ(surfaces(JointBoxProof::bad_box), (Named{StopReason::snapshot, 3}));
    EXPECT_EQ(surfaces(JointBoxProof::not_run), (Named{StopReason::engine, 3}));
    EXPECT_EQ(reason_with([](StopCase& stop) {
                  stop.proofs[0].containment_result.containment = Containment::a_in_b;
              }),
              (Named{StopReason::contained, 7}));
    EXPECT_EQ(reason_with([](StopCase& stop) {
                  stop.proofs[0].containment_result.status = QueryStatus::too_many_triangle_pairs;
              }),
              (Named{StopReason::capacity, 7}));
    EXPECT_EQ(reason_with([](StopCase& stop) { stop.cycle.known_answer_signature = 0; }),
              (Named{StopReason::known_answer, kNoIndex}));
    EXPECT_EQ(reason_with([](StopCase& stop) { stop.cycle.status = SnapshotStatus::unknown_tool; }),
              (Named{StopReason::tool, kNoIndex}));
    EXPECT_EQ(reason_with([](StopCase& stop) { stop.cycle.status = SnapshotStatus::not_finite; }),
              (Named{StopReason::snapshot, kNoIndex}));
}

// While nobody was permitted to move there is nothing to withdraw, and speeds are not known yet.
TEST(MonitorStoppable, BeforeTheFirstPermitAPairThatIsNotProvenIsWaitedFor) {
    StopCase stop;
    stop.cycle.is_settled = false;
    stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
    const CycleResult early = stop.step();
    EXPECT_FALSE(early.has_permit);
    EXPECT_FALSE(early.stops_now);
    EXPECT_EQ(early.reason, StopReason::predicted);
    EXPECT_EQ(early.pair, 7U);
    EXPECT_FALSE(stop.state.is_stopped);
    stop.proofs[0] = StopCase::proven(7);
    EXPECT_TRUE(stop.step().has_permit);
    stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
    EXPECT_TRUE(stop.step().stops_now) << "what was given is withdrawn, settled or not";
    reset(stop.state);
    EXPECT_FALSE(stop.step().stops_now) << "after a reset it is as at the start";
}

TEST(MonitorStoppable, PredictedIsWaitedForHoweverLongAndNothingElseIs) {
    StopCase stop;
    stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
    for (const bool ready : {false, true}) {
        for (int i = 0; i < 100; ++i) {
            EXPECT_FALSE(stop.step(ready).stops_now) << "settled: still nothing to withdraw";
        }
    }
    stop.proofs[0] = StopCase::proven(7);
    EXPECT_TRUE(stop.step().has_permit);
    StopCase left;
    left.cycle.status = SnapshotStatus::left_path;
    EXPECT_FALSE(left.step().stops_now);
    left.cycle.status = SnapshotStatus::left_jog;
    EXPECT_FALSE(left.step().stops_now);
    left.cycle.status = SnapshotStatus::left_travel;
    EXPECT_FALSE(left.step().stops_now);
    StopCase inside;
    inside.cycle.is_settled = false;
    inside.proofs[0].containment_result.containment = Containment::b_in_a;
    EXPECT_TRUE(inside.step(false).stops_now);
    StopCase broken;
    broken.cycle.is_settled = false;
    broken.cycle.known_answer_signature = 0;
    EXPECT_TRUE(broken.step(false).stops_now);
}

// A board that moves without a permit does not keep its promise: it is told to stop as soon as that
// is known, which takes a receiver that is ready and samples enough. Its jog waits for a permit.
TEST(MonitorStoppable, AMachineThatMovesWithoutAPermitIsStopped) {
    const auto stops = [](bool is_settled, bool ready, bool is_jog) {
        StopCase stop;
        stop.cycle.is_moving = true;
        stop.cycle.is_settled = is_settled;
        stop.cycle.is_jog = is_jog;
        stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
        return stop.step(ready, false).stops_now;
    };
    EXPECT_TRUE(stops(true, true, false));
    EXPECT_FALSE(stops(false, true, false));
    EXPECT_FALSE(stops(true, false, false));
    EXPECT_FALSE(stops(true, true, true));
}

// Ready and not armed: the monitor would give permits, and none is sent. What is not proven then
// has nothing to withdraw either.
TEST(MonitorStoppable, APermitThatIsNotSentIsNothingToWithdraw) {
    StopCase stop;
    EXPECT_TRUE(stop.step(true, false).has_permit) << "the guard has to see it to become ready";
    stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
    EXPECT_FALSE(stop.step(true, false).stops_now);
    EXPECT_FALSE(stop.step(true, true).stops_now) << "armed, and no permit yet";
    stop.proofs[0] = StopCase::proven(7);
    EXPECT_TRUE(stop.step(true, true).has_permit);
    stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
    EXPECT_TRUE(stop.step(true, true).stops_now);
}

}  // namespace
}  // namespace axg
