// SPDX-License-Identifier: Apache-2.0
// The first part of the last stage, which is asked alone: what it loses, and what it does not.
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <span>

#include "core/certificate/staged_proof.hpp"
#include "core/collision/known_answer.hpp"
#include "core/collision/query_tree.hpp"
#include "tests/support/told_slides.hpp"

namespace axg {
namespace {

using test::kKnownAnswerMesh;
using test::Slides;
using test::ToldEngine;

/// A stage on the host, and the last one of a GPU: one slide, in float alone.
struct SharedStages {
    Slides slides;
    ToldEngine host, gpu;
    std::optional<std::uint32_t> of_host;  // empty: all stages but the last
    StagedWork work;

    explicit SharedStages(std::function<Proof(const Query&)> judge, std::uint32_t pairs = 1)
        : slides(pairs), host{.judge = judge}, gpu{.judge = judge, .prefers_batches = true} {}
    void prove(bool is_shared, std::uint32_t stages = 2) {
        CyclePlan plan = Slides::plan(stages, TreeForm::leaves, 16);
        plan.queries[stages - 1] = stages == 3 ? 64 : 16;
        for (WorkLists& lists : plan.lists) {
            lists.rechecks = 0;
        }
        Engine both = gpu.engine();
        both.host = {of_host.value_or(stages - 1), &host, ToldEngine::run};
        work = StagedProver::create(slides.machine, static_cast<std::uint32_t>(slides.tasks.size()),
                                    plan, kKnownAnswerMesh)
                   ->prove(is_shared ? both : host.engine(), slides.tasks, slides.results);
    }
};

// In the last stage one part that is not far loses the task: the host asks the first one alone, and
// where that is near no batch is launched.
TEST(FirstPart, AloneMayLoseTheLastStage) {
    for (const bool is_shared : {false, true}) {
        SCOPED_TRACE(is_shared);
        SharedStages near([](const Query&) { return Proof::not_proven; });
        near.prove(is_shared);
        EXPECT_TRUE(near.gpu.calls.empty());
        ASSERT_EQ(near.host.calls.size(), 2U);
        ASSERT_EQ(near.host.calls[1].size(), 1U) << "without the known-answer test";
        EXPECT_NEAR(near.host.calls[1][0].pose.t[0], -7.5, 1e-9);
        EXPECT_EQ(near.host.groups[1][0].share, kFirstPartShare);
        EXPECT_EQ(near.work.queries, 2U);
        EXPECT_EQ(near.work.planned_queries, 17U) << "what advisories may ask is as without";
        EXPECT_EQ(near.work.batches, 0U);
        EXPECT_EQ(near.work.known_answer_signature, kKnownAnswerSignature);
        const JointBoxResult& result = near.slides.results[0];
        EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
        EXPECT_EQ(result.status, QueryStatus::ok);
        EXPECT_EQ(result.queries, 2U);
        EXPECT_NEAR(result.open.centre[0], -7.5, 1e-9);
        EXPECT_NEAR(result.open.half[0], 0.5, 1e-9);

        SharedStages far(
            [](const Query& query) { return query.r_mm <= 1.1 ? Proof::far : Proof::not_proven; });
        far.prove(is_shared);
        EXPECT_EQ(far.slides.results[0].proof, JointBoxProof::proven);
        EXPECT_EQ(far.work.queries, 17U) << "asked twice, it counts once";
        EXPECT_EQ(far.work.planned_queries, 17U);
        EXPECT_EQ(far.work.batches, is_shared ? 1U : 0U);
        EXPECT_EQ(far.host.calls.size(), is_shared ? 2U : 3U) << "the first part was asked alone";

        SharedStages last([](const Query& query) {  // any other part loses it too
            return query.r_mm <= 1.1 && query.pose.t[0] < 7 ? Proof::far : Proof::not_proven;
        });
        last.prove(is_shared);
        EXPECT_EQ(last.slides.results[0].proof, JointBoxProof::budget_spent);
        EXPECT_NEAR(last.slides.results[0].open.centre[0], 7.5, 1e-9);

        SharedStages third([](const Query& query) {  // after the second stage all 8 parts are open
            return query.r_mm <= 0.7 ? Proof::far : Proof::not_proven;
        });
        third.prove(is_shared, 3);
        EXPECT_EQ(third.slides.results[0].proof, JointBoxProof::proven);
        EXPECT_EQ(third.work.queries, 2U + 14U + 64U);

        SharedStages two([](const Query&) { return Proof::not_proven; }, 2);
        two.prove(is_shared);
        EXPECT_EQ(two.host.calls.back().size(), is_shared ? 4U : 18U) << "both tasks at once";
        EXPECT_EQ(two.gpu.calls.size(), is_shared ? 1U : 0U);
    }
}

// A GPU that answers the stage before has none to ask: a launch of one query costs too much.
TEST(FirstPart, IsNotAskedWhereTheStageBeforeIsTheGpus) {
    for (const std::uint32_t of_host : {0U, 1U}) {
        SharedStages near([](const Query&) { return Proof::not_proven; });
        near.of_host = of_host;
        near.prove(true, 3);
        EXPECT_EQ(near.slides.results[0].proof, JointBoxProof::budget_spent);
        EXPECT_EQ(near.host.calls.size(), of_host);
        EXPECT_EQ(near.gpu.calls.size(), 6U - of_host);
        EXPECT_EQ(near.work.queries, 2U + 14U + 64U);
        EXPECT_EQ(near.work.planned_queries, 2U + 14U + 64U);
    }
}

// A path of more joints than a GPU poses: of no pair of that machine, whatever its boxes are cut
// along, and neither has the longest cycle one.
TEST(FirstPart, IsNotAskedOfAMachineOfManyJoints) {
    SharedStages near([](const Query&) { return Proof::not_proven; });
    near.slides.machine.bodies.resize(kTreeJointsMax + 2, near.slides.machine.bodies[1]);
    near.prove(true);
    EXPECT_EQ(near.slides.results[0].proof, JointBoxProof::budget_spent);
    EXPECT_EQ(near.host.calls.size(), 1U);
    EXPECT_EQ(near.gpu.calls.size(), 1U);
}

// What has no room in its share says nothing, and an engine that is lost loses the cycle.
TEST(FirstPart, WithoutAnAnswerDecidesNothing) {
    const auto far_or_near = [](const Query& query) {
        return query.r_mm <= 1.1 ? Proof::far : Proof::not_proven;
    };
    for (const bool is_shared : {false, true}) {
        for (const QueryStatus status :
             {QueryStatus::ok, QueryStatus::too_many_leaf_pairs, QueryStatus::bad_query,
              QueryStatus::not_run, QueryStatus::bad_rounding}) {
            SCOPED_TRACE(static_cast<int>(status));
            SharedStages first(far_or_near);
            first.host.spoil = [status](std::uint32_t call, std::span<const Query>,
                                        std::span<QueryResult> results,
                                        std::span<GroupWork> groups) {
                if (call != 1) {
                    return;
                }
                results[0] = {.status = status};
                if (status == QueryStatus::ok) {
                    groups[0].used.triangle_pairs = groups[0].share.triangle_pairs + 1;
                }
            };
            first.prove(is_shared);
            const bool is_lost =
                status == QueryStatus::not_run || status == QueryStatus::bad_rounding;
            EXPECT_EQ(first.slides.results[0].proof,
                      is_lost ? JointBoxProof::engine_failed : JointBoxProof::proven);
            EXPECT_EQ(first.slides.results[0].status, is_lost ? status : QueryStatus::ok);
        }
    }
}

}  // namespace
}  // namespace axg
