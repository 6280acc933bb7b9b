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

    Cycle() {
        pair_queries.status = SnapshotStatus::ok;
        pair_queries.count = 3;
        pair_queries.pair[0] = 7;
        pair_queries.pair[1] = 3;
        pair_queries.pair[2] = 9;
    }
    [[nodiscard]] CycleResult judge(bool ready = true) const {
        return axg::judge(pair_queries, query_results, containment_results, ready);
    }
};

TEST(Monitor, GivesAPermitWhenEverythingIsProven) {
    Cycle cycle;
    const CycleResult result = cycle.judge();
    EXPECT_TRUE(result.has_permit);
    EXPECT_FALSE(result.is_stop);
    EXPECT_EQ(result.reason, StopReason::none);
    EXPECT_EQ(result.pair, kNoIndex);
    EXPECT_EQ(result.not_proven, 0U);
    EXPECT_EQ(result.known_answer_signature, kKnownAnswerSignature);
}

TEST(Monitor, ZeroedMemoryHasNoPermit) {
    EXPECT_FALSE(CycleResult{}.has_permit);
    Cycle cycle;
    cycle.query_results.assign(5, QueryResult{});
    const CycleResult result = cycle.judge();
    EXPECT_FALSE(result.has_permit);
    EXPECT_EQ(result.reason, StopReason::engine);
    EXPECT_EQ(result.known_answer_signature, 0);
    const CycleResult nothing = axg::judge(PairQueries{}, {}, {}, true);
    EXPECT_FALSE(nothing.has_permit);
    EXPECT_EQ(nothing.reason, StopReason::engine);
}

TEST(Monitor, GivesNoPermitUnlessTheReceiverIsReadyAndDoesNotStopForIt) {
    Cycle cycle;
    const CycleResult early = cycle.judge(false);
    EXPECT_FALSE(early.has_permit);
    EXPECT_FALSE(early.is_stop);
    EXPECT_TRUE(cycle.judge(true).has_permit);
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
        const CycleResult result = cycle.judge();
        EXPECT_FALSE(result.has_permit);
        EXPECT_TRUE(result.is_stop);
        EXPECT_EQ(result.reason, GetParam().reason);
        EXPECT_EQ(result.pair, cycle.pair_queries.pair[at]);
        EXPECT_EQ(result.not_proven, 1U);
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
            const CycleResult result = cycle.judge();
            EXPECT_FALSE(result.has_permit);
            EXPECT_TRUE(result.is_stop);
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
    EXPECT_EQ(cycle.judge().reason, StopReason::contact);
}

TEST(Monitor, TheFirstPairInOrderNamesTheStop) {
    Cycle cycle;
    cycle.query_results[1] = near_result();
    cycle.query_results[2].status = QueryStatus::too_many_rechecks;
    const CycleResult result = cycle.judge();
    EXPECT_EQ(result.pair, 3U);
    EXPECT_EQ(result.reason, StopReason::contact);
    EXPECT_EQ(result.not_proven, 2U);
}

TEST(Monitor, AWrongKnownAnswerStopsWhicheverHalfIsWrong) {
    const auto after = [](std::size_t at, const QueryResult& query_result) {
        Cycle cycle;
        cycle.query_results[at] = query_result;
        return cycle.judge();
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
        EXPECT_EQ(cycle.judge().reason, StopReason::known_answer);
    }
}

TEST(Monitor, ASnapshotThatFailedStopsUnderItsName) {
    for (const auto& [status, reason] : {std::pair{SnapshotStatus::unknown_tool, StopReason::tool},
                                         {SnapshotStatus::wrong_axes, StopReason::snapshot},
                                         {SnapshotStatus::not_finite, StopReason::snapshot},
                                         {SnapshotStatus::not_run, StopReason::engine}}) {
        PairQueries pair_queries;
        pair_queries.status = status;
        const CycleResult result = judge(pair_queries, {}, {}, true);
        EXPECT_FALSE(result.has_permit);
        EXPECT_TRUE(result.is_stop);
        EXPECT_EQ(result.reason, reason);
        EXPECT_EQ(result.known_answer_signature, 0);
    }
}

// It remembers nothing: the guard latches, and it is model-checked.
TEST(Monitor, ACycleIsJudgedByItselfWhateverWasBefore) {
    Cycle cycle;
    cycle.query_results[1] = near_result();
    EXPECT_TRUE(cycle.judge().is_stop);
    EXPECT_TRUE(cycle.judge().is_stop) << "and as long as it lasts";
    cycle.query_results[1] = far_result();
    EXPECT_TRUE(cycle.judge().has_permit);
}

TEST(Monitor, EveryReasonHasAWordOfItsOwn) {
    std::vector<std::string> words;
    for (int i = 0; i <= static_cast<int>(StopReason::left_limits); ++i) {
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
    EXPECT_DEATH((void)cycle.judge(), "");
    Cycle other;
    other.containment_results.pop_back();
    EXPECT_DEATH((void)other.judge(), "");
}

/// A certificate of two pairs (7 and 3 of the machine), proven, known-answer test passed.
struct StopCase {
    std::vector<PairProof> proofs{proven(7), proven(3)};
    StopCycle cycle{.status = SnapshotStatus::ok,
                    .known_answer_signature = kKnownAnswerSignature,
                    .is_settled = true};

    static PairProof proven(std::uint32_t pair) {
        PairProof proof;
        proof.pair = pair;
        proof.surfaces.proof = JointBoxProof::proven;
        proof.surfaces.status = QueryStatus::ok;
        proof.containment_result = {QueryStatus::ok, Containment::none};
        return proof;
    }
    CycleResult judge(bool ready = true, bool is_armed = true) {
        cycle.proofs = proofs;
        return axg::judge(cycle, ready, is_armed);
    }
};

TEST(MonitorStoppable, GivesAPermitWhenEverythingIsProvenToStandstill) {
    StopCase stop;
    const CycleResult result = stop.judge();
    EXPECT_TRUE(result.has_permit);
    EXPECT_EQ(result.reason, StopReason::none);
    EXPECT_EQ(result.not_proven, 0U);
    EXPECT_EQ(result.known_answer_signature, kKnownAnswerSignature);
    const CycleResult early = stop.judge(false);
    EXPECT_FALSE(early.has_permit) << "not without a receiver that trusts its pictures";
    EXPECT_FALSE(early.is_stop);
}

TEST(MonitorStoppable, ZeroedMemoryHasNoPermit) {
    const CycleResult nothing = axg::judge(StopCycle{}, true, true);
    EXPECT_FALSE(nothing.has_permit);
    EXPECT_EQ(nothing.reason, StopReason::engine);
    StopCase stop;
    stop.proofs[1] = PairProof{};
    EXPECT_EQ(stop.judge().reason, StopReason::engine);
}

TEST(MonitorStoppable, WhatIsNotProvenStopsUnderItsName) {
    const auto reason_with = [](auto&& breaks) {
        StopCase stop;
        EXPECT_TRUE(stop.judge().has_permit);
        breaks(stop);
        const CycleResult result = stop.judge();
        EXPECT_TRUE(result.is_stop);
        EXPECT_FALSE(result.has_permit);
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

// While no permit is sent there is nothing to withdraw, and speeds may not be known yet.
TEST(MonitorStoppable, BeforeArmingAPairThatIsNotProvenIsWaitedForHoweverLong) {
    StopCase stop;
    stop.proofs[0].surfaces.proof = JointBoxProof::budget_spent;
    for (const bool is_settled : {false, true}) {
        stop.cycle.is_settled = is_settled;
        const CycleResult early = stop.judge(true, false);
        EXPECT_FALSE(early.has_permit);
        EXPECT_FALSE(early.is_stop);
        EXPECT_EQ(early.reason, StopReason::predicted);
        EXPECT_EQ(early.pair, 7U);
        EXPECT_TRUE(stop.judge(true, true).is_stop) << "what is given is withdrawn, settled or not";
    }
    StopCase left;
    for (const SnapshotStatus status : {SnapshotStatus::left_path, SnapshotStatus::left_jog,
                                        SnapshotStatus::left_travel, SnapshotStatus::left_limits}) {
        left.cycle.status = status;
        EXPECT_FALSE(left.judge(true, false).is_stop);
        EXPECT_TRUE(left.judge(true, true).is_stop);
    }
}

TEST(MonitorStoppable, BeforeArmingNothingElseIsWaitedFor) {
    StopCase inside;
    inside.cycle.is_settled = false;
    inside.proofs[0].containment_result.containment = Containment::b_in_a;
    EXPECT_TRUE(inside.judge(false, false).is_stop);
    StopCase broken;
    broken.cycle.is_settled = false;
    broken.cycle.known_answer_signature = 0;
    EXPECT_TRUE(broken.judge(false, false).is_stop);
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
        return stop.judge(ready, false).is_stop;
    };
    EXPECT_TRUE(stops(true, true, false));
    EXPECT_FALSE(stops(false, true, false));
    EXPECT_FALSE(stops(true, false, false));
    EXPECT_FALSE(stops(true, true, true));
}

TEST(MonitorStoppable, BeforeArmingItGivesThePermitThatTheGuardKeeps) {
    StopCase stop;
    EXPECT_TRUE(stop.judge(true, false).has_permit) << "the guard has to see it to become ready";
}

}  // namespace
}  // namespace axg
