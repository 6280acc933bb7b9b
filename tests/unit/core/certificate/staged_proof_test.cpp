// SPDX-License-Identifier: Apache-2.0
// The prover in stages: what it asks and when, for engines that prefer batches and for those that
// do not; every box of a tree is needed; what a group or an engine loses, and what it does not.
#include "core/certificate/staged_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "core/collision/known_answer.hpp"
#include "tests/support/told_slides.hpp"

namespace axg {
namespace {

using test::far_to;
using test::kAmple;
using test::kKnownAnswerMesh;
using test::Slides;
using test::ToldEngine;

/// Pairs, each once more over a box of 32 mm.
struct WiderSlides : Slides {
    explicit WiderSlides(std::uint32_t pairs) : Slides(2 * pairs) {
        for (std::uint32_t i = 0; i < pairs; ++i) {
            tasks[pairs + i].mesh_a = tasks[i].mesh_a;
            tasks[pairs + i].box.half[0] = 16;
        }
    }
    void prove(ToldEngine& fake, const CyclePlan& plan) {
        auto prover =
            StagedProver::create(machine, static_cast<std::uint32_t>(tasks.size()), plan, kNoIndex);
        work = prover->prove(fake.engine(), tasks, results, true);
    }
};

// The first stages may go to another engine, on the host: with the same results, one launch less
// each, and where that engine is lost the cycle is.
TEST(StagedProver, TheFirstStagesMayGoToTheHost) {
    const auto judge = [](const Query& query) {
        const double far_mm[] = {20, 4.6, 1.1, 0.2};  // of each pair
        return query.r_mm <= far_mm[query.mesh_a - 1] ? Proof::far : Proof::not_proven;
    };
    for (const std::uint32_t stages : {2U, 3U}) {
        for (std::uint32_t of_host = 0; of_host <= stages; ++of_host) {
            SCOPED_TRACE(std::to_string(of_host) + " of " + std::to_string(stages));
            Slides slides(4), other(4);
            CyclePlan plan = Slides::plan(stages, TreeForm::leaves, 16);
            plan.queries[1] = stages == 3 ? 8 : 16;
            auto prover = StagedProver::create(slides.machine, 4, plan, kKnownAnswerMesh);
            ToldEngine alone{.judge = judge, .prefers_batches = true};
            const StagedWork wanted = prover->prove(alone.engine(), slides.tasks, slides.results);
            ToldEngine gpu{.judge = judge, .prefers_batches = true}, host{.judge = judge};
            Engine both = gpu.engine();
            both.host = {of_host, &host, ToldEngine::run};
            const StagedWork found = prover->prove(both, other.tasks, other.results);
            // Of three stages the second has two calls: the boxes once more, and a round.
            EXPECT_EQ(gpu.calls.size(), stages - of_host + (stages == 3 && of_host < 2 ? 1 : 0));
            EXPECT_EQ(host.calls.empty(), of_host == 0);
            EXPECT_EQ(found.stages, wanted.stages);
            EXPECT_EQ(found.known_answer_signature, kKnownAnswerSignature);
            for (std::uint32_t i = 0; i < 4; ++i) {
                EXPECT_EQ(other.results[i].proof, slides.results[i].proof) << i;
                EXPECT_EQ(other.results[i].open.centre, slides.results[i].open.centre) << i;
            }
            EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
            EXPECT_EQ(slides.results[3].proof, JointBoxProof::budget_spent);
            host.spoil = [](std::uint32_t, std::span<const Query>, std::span<QueryResult> results,
                            std::span<GroupWork>) { results.back() = QueryResult{}; };
            static_cast<void>(prover->prove(both, other.tasks, other.results));
            EXPECT_EQ(other.results[0].proof == JointBoxProof::engine_failed, of_host != 0);
        }
    }
}

// A pair that is far over the larger box is asked once; one that is not gets its tree over the
// smaller box, and the larger one none.
TEST(StagedProver, WhatIsFarOverALargerBoxIsNotAskedAgain) {
    for (const bool prefers_batches : {false, true}) {
        WiderSlides slides(3);
        ToldEngine fake{.judge =
                            [](const Query& query) {
                                const double far_mm[] = {20, 9, 4.6};  // of each pair
                                return query.r_mm <= far_mm[query.mesh_a - 1] ? Proof::far
                                                                              : Proof::not_proven;
                            },
                        .prefers_batches = prefers_batches};
        slides.prove(fake, Slides::plan(2, TreeForm::leaves, 8));
        for (std::uint32_t i = 0; i < 3; ++i) {
            EXPECT_EQ(slides.results[i].proof, JointBoxProof::proven) << i;
            EXPECT_EQ(slides.results[3 + i].proof,
                      i == 0 ? JointBoxProof::proven : JointBoxProof::budget_spent);
        }
        // Three larger boxes, those of two or all three pairs, and eight leaves of the last one.
        EXPECT_EQ(fake.queries(), 3U + (prefers_batches ? 3U : 2U) + 8U);
        EXPECT_EQ(fake.calls.size(), prefers_batches ? 2U : 3U) << "no launch more";
        EXPECT_EQ(fake.groups[0].size(), 7U) << "each question a group, and the known-answer test";
    }
}

// A larger box whose share was spent proves nothing, of the pair neither.
TEST(StagedProver, ALargerBoxThatSpentItsShareProvesNothing) {
    for (const bool prefers_batches : {false, true}) {
        WiderSlides slides(1);
        ToldEngine fake{.judge =
                            [](const Query& query) {
                                return query.r_mm > 9 ? Proof::far
                                                      : Proof::not_proven;  // the larger one alone
                            },
                        .prefers_batches = prefers_batches,
                        .spoil =
                            [](std::uint32_t, std::span<const Query> queries,
                               std::span<QueryResult>, std::span<GroupWork> groups) {
                                for (const Query& query : queries) {
                                    if (query.r_mm > 9) {
                                        groups[query.group].used.box_rows =
                                            groups[query.group].share.box_rows + 1;
                                    }
                                }
                            }};
        slides.prove(fake, Slides::plan(2, TreeForm::leaves, 8));
        EXPECT_EQ(slides.results[1].proof, JointBoxProof::budget_spent);
        EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent);
    }
}

TEST(StagedProver, OneStageIsEnoughForWhatIsFarAsItIs) {
    Slides slides;
    ToldEngine fake = far_to(8.6);
    slides.prove(fake, Slides::plan(2, TreeForm::whole, 14));
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
    EXPECT_EQ(slides.work.stages, 1U);
    EXPECT_EQ(fake.queries(), 1U);
}

TEST(StagedProver, ATreeIsAskedAsDeepAsItsQueriesFitAndNoDeeper) {
    for (const bool prefers_batches : {false, true}) {
        for (const bool fits : {true, false}) {
            Slides slides;
            ToldEngine fake = far_to(1.6);  // 8 -> 4 -> 2 -> 1: three levels
            fake.prefers_batches = prefers_batches;
            slides.prove(fake, Slides::plan(2, TreeForm::whole, fits ? 14 : 13));
            EXPECT_EQ(slides.results[0].proof,
                      fits ? JointBoxProof::proven : JointBoxProof::budget_spent);
            EXPECT_EQ(fake.queries(), fits ? 15U : 7U);
            EXPECT_EQ(fake.calls.size(), prefers_batches ? 2U : fits ? 4U : 3U);

            Slides leaves;
            ToldEngine other = far_to(1.6);
            other.prefers_batches = prefers_batches;
            leaves.prove(other, Slides::plan(2, TreeForm::leaves, fits ? 8 : 7));
            EXPECT_EQ(leaves.results[0].proof,
                      fits ? JointBoxProof::proven : JointBoxProof::budget_spent);
            EXPECT_EQ(other.queries(), fits ? 9U : 5U);
            EXPECT_EQ(other.calls.size(), 2U);
        }
    }
}

// A far box proves its own parts, and no other.
TEST(StagedProver, EveryLeafOfATreeIsNeeded) {
    for (const auto& [form, stages] :
         {std::pair{TreeForm::whole, 2U}, {TreeForm::leaves, 2U}, {TreeForm::leaves, 3U}}) {
        for (const bool prefers_batches : {false, true}) {
            for (int leaf = 0; leaf < 8; ++leaf) {
                const double bad_mm = -6.7 + 2 * leaf;
                Slides slides;
                ToldEngine fake = far_to(1.6);
                fake.prefers_batches = prefers_batches;
                fake.judge = [bad_mm](const Query& query) {
                    const double reach_mm = query.r_mm - 0.5;
                    const bool is_bad = std::fabs(query.pose.t[0] - bad_mm) < reach_mm;
                    return is_bad || query.r_mm > 2.6 ? Proof::not_proven : Proof::far;
                };
                slides.prove(fake, Slides::plan(stages, form, 14));
                EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent) << leaf;
                fake.judge = far_to(1.6).judge;
                slides.prove(fake, Slides::plan(stages, form, 14));
                EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven) << leaf;
            }
        }
    }
}

// Whole trees: a parent that is far makes up for leaves that are not, and not for its siblings.
TEST(StagedProver, AFarParentCoversItsLeaves) {
    for (const bool prefers_batches : {false, true}) {
        Slides slides;
        ToldEngine fake{.judge =
                            [](const Query& query) {
                                return query.r_mm < 5 && query.r_mm > 4 ? Proof::far
                                                                        : Proof::not_proven;
                            },
                        .prefers_batches = prefers_batches};
        slides.prove(fake, Slides::plan(2, TreeForm::whole, 14));
        EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
        EXPECT_EQ(fake.queries(), prefers_batches ? 15U : 3U);

        ToldEngine half = fake;
        half.calls.clear();
        half.judge = [](const Query& query) {
            return query.r_mm < 5 && query.r_mm > 4 && query.pose.t[0] > 0 ? Proof::far
                                                                           : Proof::not_proven;
        };
        slides.prove(half, Slides::plan(2, TreeForm::whole, 14));
        EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent) << "and, not or";
    }
}

TEST(StagedProver, TheThirdStageAsksBelowWhatTheSecondLeftOpen) {
    Slides slides;
    ToldEngine fake = far_to(1.6);
    slides.prove(fake, Slides::plan(2, TreeForm::leaves, 4));
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent) << "parts of 4 mm";
    ToldEngine again = far_to(1.6);
    slides.prove(again, Slides::plan(3, TreeForm::leaves, 14));
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
    EXPECT_EQ(slides.work.stages, 2U);
    ToldEngine deeper{.judge = [](const Query& query) {
        const bool is_near_end = query.pose.t[0] > 6.5;  // the last part of 2 mm wants halves
        return query.r_mm <= (is_near_end ? 1.1 : 1.6) ? Proof::far : Proof::not_proven;
    }};
    slides.prove(deeper, Slides::plan(3, TreeForm::leaves, 14));
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
    EXPECT_EQ(slides.work.stages, 3U);
    ASSERT_EQ(deeper.groups.size(), 6U) << "whole, once more, three rounds, the last stage";
    EXPECT_FALSE(deeper.groups[4][0].needs_all) << "the third stage wants every result";
    EXPECT_TRUE(deeper.groups[5][0].needs_all);
}

// The second of three stages: what is far is halved no further, and a group has queries of its own.
TEST(StagedProver, ARoundHalvesOnlyWhatIsOpen) {
    for (const bool prefers_batches : {false, true}) {
        Slides slides(2);
        ToldEngine fake{.judge =
                            [](const Query& query) {
                                const bool is_end = query.pose.t[0] + query.r_mm - 0.5 > 7.9;
                                const double far_mm = is_end ? 1.1 : 4.6;  // in four halvings
                                return query.mesh_a == 1 && query.r_mm <= far_mm
                                           ? Proof::far
                                           : Proof::not_proven;
                            },
                        .prefers_batches = prefers_batches};
        slides.prove(fake, Slides::plan(3, TreeForm::leaves, 56));
        EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
        EXPECT_EQ(slides.results[0].queries, 2U + 4 * 2U) << "an eighth of its 28 at once";
        EXPECT_EQ(slides.results[1].proof, JointBoxProof::budget_spent);
        EXPECT_EQ(slides.results[1].queries, 2U + 2U + 4U + 8U + 8U * 4U) << "no fourth round";
        ASSERT_EQ(fake.calls.size(), 2U + 4U + 1U);
        EXPECT_EQ(fake.calls[5].size(), 2U) << "the other group has no more queries";
    }
}

TEST(StagedProver, BoxesAreHalvedInSoManyRoundsAndNoMore) {
    Slides slides;
    ToldEngine fake{.judge = [](const Query& query) {
        const bool is_end = query.pose.t[0] + query.r_mm - 0.5 > 7.9999;
        return is_end ? Proof::not_proven : Proof::far;
    }};
    CyclePlan plan = Slides::plan(3, TreeForm::leaves, 64);
    plan.queries[2] = 1;
    slides.prove(fake, plan);
    EXPECT_EQ(fake.calls.size(), 2U + kRoundsMax);
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent);
}

// A quarter of the stage's lists for the whole boxes, and the rest for those that stay open: each
// has what it left of its first share besides, and nothing of another group's.
TEST(StagedProver, WhoIsAskedAgainKeepsWhatItLeaves) {
    for (const bool prefers_batches : {false, true}) {
        Slides slides(4);
        CyclePlan plan = Slides::plan(3, TreeForm::leaves, 32);
        plan.lists[1] = {80, 160, 240, 1024, 40};
        ToldEngine fake{.judge =
                            [](const Query& query) {
                                return query.mesh_a > 2 || query.r_mm <= 1.6 ? Proof::far
                                                                             : Proof::not_proven;
                            },
                        .prefers_batches = prefers_batches};
        // Far only in the second call: the first had too short a list for pairs 3 and 4.
        fake.spoil = [](std::uint32_t call, std::span<const Query>, std::span<QueryResult> results,
                        std::span<GroupWork> groups) {
            if (call == 0) {
                groups[2].used.leaf_pairs = groups[3].used.leaf_pairs =
                    groups[2].share.leaf_pairs + 1;
            }
            if (call == 1) {
                groups[0].used = {1, 2, 3, 16, 1};
                groups[1].used = {6, 2, 3, 64, 1};  // more nodes than its share
                results[0].proof = results[1].proof = Proof::not_proven;
            }
        };
        slides.prove(fake, plan);
        for (const std::uint32_t i : {0U, 1U, 2U, 3U}) {
            EXPECT_EQ(slides.results[i].proof, JointBoxProof::proven) << i;
        }
        ASSERT_GE(fake.groups.size(), 3U);
        EXPECT_EQ(fake.groups[1][0].share, (WorkLists{5, 10, 15, 64, 2}));
        EXPECT_EQ(fake.groups[2][0].share, (WorkLists{30 + 4, 60 + 8, 90 + 12, 384 + 48, 15 + 1}));
        EXPECT_EQ(fake.groups[2][1].share, (WorkLists{30 + 0, 60 + 8, 90 + 12, 384 + 0, 15 + 1}));
        EXPECT_EQ(slides.results[2].queries, 2U) << "asked once more, and not halved";
    }
}

// Nine halvings of every part: the second of three stages leaves none of its 16 boxes proven.
TEST(StagedProver, ThreeStagesOfAPlanGetAsDeepAsTwoAndDeeperWhereFewBoxesAreOpen) {
    for (const std::uint32_t stages : {2U, 3U}) {
        for (const std::uint32_t halvings : {9U, 10U}) {
            Slides slides;
            ToldEngine fake = far_to(0.501 + std::ldexp(8, -static_cast<int>(halvings)));
            slides.prove(fake, plan_of(stages, 1, 512, kAmple));
            EXPECT_EQ(slides.results[0].proof == JointBoxProof::proven, halvings == 9) << stages;
        }
        Slides slides;
        ToldEngine fake{.judge = [](const Query& query) {
            const bool is_end = query.pose.t[0] + query.r_mm - 0.5 > 7.9;
            return query.r_mm <= (is_end ? 0.501 : 1.01) ? Proof::far : Proof::not_proven;
        }};
        slides.prove(fake, plan_of(stages, 1, 512, kAmple));
        EXPECT_EQ(slides.results[0].proof == JointBoxProof::proven, stages == 3);
        EXPECT_EQ(fake.queries(), stages == 3 ? 2U + 4U + 8U + 16U + 2U + 512U : 1U + 512U);
    }
}

TEST(StagedProver, ARoundThatIsTooLargeForTheQueriesIsLeftOut) {
    for (const std::uint32_t count : {16U, 17U}) {  // 32 queries are two for each of sixteen
        Slides slides(count);
        ToldEngine fake = far_to(0.501 + 0.5);  // four halvings
        slides.prove(fake, plan_of(3, count, 512, kAmple));
        for (const JointBoxResult& result : slides.results) {
            EXPECT_EQ(result.proof, JointBoxProof::proven);
        }
        EXPECT_EQ(fake.calls.size(), count == 16 ? 4U : 3U);
        EXPECT_EQ(fake.calls.back().size(), count == 16 ? 512U : 17U * 16U);
    }
}

TEST(StagedProver, DepthIsThatOfAllStagesTogether) {
    Slides slides;
    CyclePlan plan = Slides::plan(3, TreeForm::leaves, 1024);
    plan.depth_max = 2;
    ToldEngine fake = far_to(1.6);
    slides.prove(fake, plan);
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent);
    EXPECT_EQ(fake.queries(), 2U + 4U);
    plan.depth_max = 3;
    slides.prove(fake, plan);
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
}

TEST(StagedProver, EachTaskIsAGroupWithAnEqualShareAndOneThatIsProvenLeavesItsOwn) {
    Slides slides(3);
    CyclePlan plan = Slides::plan(2, TreeForm::whole, 28);
    plan.lists[0] = {30, 31, 32, 100, 34};
    plan.lists[1] = {100, 101, 102, 103, 104};
    ToldEngine fake{.judge =
                        [](const Query& query) {
                            return query.mesh_a == 2 || query.r_mm <= 1.6 ? Proof::far
                                                                          : Proof::not_proven;
                        },
                    .prefers_batches = true};
    slides.prove(fake, plan, kKnownAnswerMesh);
    for (const JointBoxResult& result : slides.results) {
        EXPECT_EQ(result.proof, JointBoxProof::proven);
    }
    ASSERT_EQ(fake.groups.size(), 2U);
    ASSERT_EQ(fake.groups[0].size(), 4U);
    EXPECT_EQ(fake.groups[0][0].share, (WorkLists{10, 10, 10, 32, 11}));
    EXPECT_EQ(fake.groups[0][3].share, kKnownAnswerShare);
    ASSERT_EQ(fake.groups[1].size(), 3U) << "two are left, and the known-answer test";
    EXPECT_EQ(fake.groups[1][1].share, (WorkLists{50, 50, 51, 48, 52}));
    for (const std::vector<Query>& call : fake.calls) {
        for (const Query& query : call) {
            const bool is_first = &call == &fake.calls[0];
            const std::uint32_t group = is_first ? query.mesh_a - 1 : query.mesh_a == 1 ? 0 : 1;
            const std::uint32_t known = is_first ? 3 : 2;
            EXPECT_EQ(query.group, query.mesh_a == kKnownAnswerMesh ? known : group);
        }
    }
}

/// A share of group 0 spent in this call, with results that say far all the same.
auto spend_in(std::uint32_t spent_call) {
    return [spent_call](std::uint32_t call, std::span<const Query>, std::span<QueryResult>,
                        std::span<GroupWork> groups) {
        if (call == spent_call) {
            groups[0].used.box_rows = groups[0].share.box_rows + 1;
        }
    };
}

TEST(StagedProver, ASpentGroupLosesItsStageAndNoOtherNotices) {
    for (const bool prefers_batches : {false, true}) {
        Slides slides(2);
        ToldEngine fake = far_to(1.6);
        fake.prefers_batches = prefers_batches;
        fake.spoil = spend_in(1);
        slides.prove(fake, Slides::plan(2, TreeForm::whole, 28));
        EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent);
        EXPECT_EQ(slides.results[0].status, QueryStatus::too_many_box_rows);
        EXPECT_EQ(slides.results[1].proof, JointBoxProof::proven);
    }
    Slides roots(2);
    ToldEngine fake = far_to(8.6);
    fake.spoil = spend_in(0);
    roots.prove(fake, Slides::plan(1, TreeForm::whole, 0));
    EXPECT_EQ(roots.results[0].proof, JointBoxProof::budget_spent);
    EXPECT_EQ(roots.results[1].proof, JointBoxProof::proven);
}

TEST(StagedProver, ASpentGroupBeginsTheNextStageWithWhatItHad) {
    for (const bool prefers_batches : {false, true}) {
        Slides slides(2);
        ToldEngine fake = far_to(1.6);
        fake.prefers_batches = prefers_batches;
        fake.spoil = spend_in(2);
        CyclePlan plan = Slides::plan(3, TreeForm::leaves, 16);
        plan.queries[2] = 64;
        slides.prove(fake, plan);
        EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven) << "with a share of its own";
        EXPECT_EQ(slides.results[1].proof, JointBoxProof::proven);
        EXPECT_EQ(slides.work.stages, 3U);
        ASSERT_EQ(fake.calls.size(), 5U) << "whole, once more, two rounds, the last stage";
        EXPECT_EQ(fake.calls[4].size(), 8U + 4U * 8U) << "from its root, and from four parts";
    }
}

// A round that is lost is the one that the share did not hold: what the one before it proved stays
// proven.
TEST(StagedProver, AShareThatIsSpentLosesOneRound) {
    Slides slides;
    ToldEngine fake{.judge = [](const Query& query) {
        const bool is_far = query.pose.t[0] < 3 ? query.r_mm < 8 : query.r_mm <= 1.1;
        return is_far ? Proof::far : Proof::not_proven;
    }};
    fake.spoil = spend_in(3);
    CyclePlan plan = Slides::plan(3, TreeForm::leaves, 16);
    plan.queries[2] = 8;
    slides.prove(fake, plan);
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::proven);
    ASSERT_EQ(fake.calls.size(), 5U) << "whole, once more, two rounds, the last stage";
    EXPECT_EQ(fake.calls[3].size(), 2U);
    EXPECT_EQ(fake.calls[4].size(), 8U) << "the other parts are proven";
}

TEST(StagedProver, AnEngineThatIsLostAnywhereProvesNothingInThatCycle) {
    for (const QueryStatus status : {QueryStatus::not_run, QueryStatus::bad_rounding}) {
        for (const auto& [stages, lost_call] :
             {std::pair{2U, 0U}, {2U, 1U}, {3U, 0U}, {3U, 1U}, {3U, 2U}}) {
            Slides slides(2);
            ToldEngine fake{.judge =
                                [](const Query& query) {
                                    return query.mesh_a == 2 || query.r_mm <= 4.6
                                               ? Proof::far
                                               : Proof::not_proven;
                                },
                            .prefers_batches = true};
            // One answer, and below a parent that is far.
            fake.spoil = [&, lost = lost_call](std::uint32_t call, std::span<const Query>,
                                               std::span<QueryResult> results,
                                               std::span<GroupWork>) {
                if (call == lost) {
                    results[results.size() - 3] = {.status = status};
                }
            };
            slides.prove(fake, Slides::plan(stages, TreeForm::whole, 14), kKnownAnswerMesh);
            for (const JointBoxResult& result : slides.results) {
                EXPECT_EQ(result.proof, JointBoxProof::engine_failed);
                EXPECT_EQ(result.status, status);
            }
        }
    }
}

TEST(StagedProver, AKnownAnswerThatIsWrongInOneStageIsFoundOut) {
    for (const std::uint32_t wrong_call : {0U, 1U}) {
        for (const std::size_t back : {1U, 2U}) {
            Slides slides;
            ToldEngine fake = far_to(1.6);
            fake.prefers_batches = true;
            fake.spoil = [&](std::uint32_t call, std::span<const Query>,
                             std::span<QueryResult> results, std::span<GroupWork>) {
                QueryResult& known = results[results.size() - back];
                if (call == wrong_call) {
                    known.proof = known.proof == Proof::far ? Proof::not_proven : Proof::far;
                }
            };
            slides.prove(fake, Slides::plan(2, TreeForm::leaves, 8), kKnownAnswerMesh);
            EXPECT_EQ(slides.work.calls, 2U);
            EXPECT_EQ(slides.work.known_answer_signature, 0);
        }
    }
    Slides slides(0);
    ToldEngine fake = far_to(0);
    slides.prove(fake, Slides::plan(2, TreeForm::leaves, 8), kKnownAnswerMesh);
    EXPECT_EQ(slides.work.known_answer_signature, kKnownAnswerSignature);
    EXPECT_EQ(slides.work.calls, 1U) << "without a task the engine is asked too";
}

TEST(StagedProver, MoreTasksThanTheFirstStageHasRoomForAreNotProven) {
    Slides slides(9);  // the plan has room for eight
    ToldEngine fake = far_to(100);
    slides.prove(fake, Slides::plan(2, TreeForm::leaves, 64));
    for (const JointBoxResult& result : slides.results) {
        EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
    }
    EXPECT_EQ(fake.queries(), 0U);
}

TEST(StagedProver, ABoxThatCannotBeCutIsAskedOnce) {
    Slides slides;
    slides.tasks[0].box.half[0] = 0;
    ToldEngine fake = far_to(0.4);
    slides.prove(fake, Slides::plan(3, TreeForm::leaves, 64));
    EXPECT_EQ(slides.results[0].proof, JointBoxProof::budget_spent);
    EXPECT_EQ(fake.queries(), 1U);
}

}  // namespace
}  // namespace axg
