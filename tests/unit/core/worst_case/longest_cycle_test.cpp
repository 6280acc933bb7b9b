// SPDX-License-Identifier: Apache-2.0
// The constructed longest cycle over the real prover: each list of each stage is full to its last
// place in every layout, each query is far, and one place less in any list loses its group.
#include "core/worst_case/longest_cycle.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/certificate/staged_proof.hpp"
#include "core/collision/known_answer.hpp"
#include "core/worst_case/query_deal.hpp"
#include "tests/support/told_slides.hpp"

namespace axg {
namespace {

using test::kKnownAnswerMesh;

constexpr WorkLists kUsual{512, 384, 2048, 3072, 0};

/// Over boxes that can be halved without end.
struct Slides : test::Slides {
    explicit Slides(std::uint32_t count) : test::Slides(count) {
        for (JointBoxTask& task : tasks) {
            task.box.half[0] = 64;
        }
    }
    StagedWork prove(LongestCycle& cycle, const CyclePlan& plan, bool has_wider = false) {
        auto prover = StagedProver::create(machine, static_cast<std::uint32_t>(tasks.size()), plan,
                                           kKnownAnswerMesh);
        cycle.begin();
        return prover->prove(cycle.engine(), tasks, results, has_wider);
    }
};

std::optional<LongestCycle> cycle_of(const CyclePlan& plan, const CycleShape& shape) {
    std::string fault;
    std::optional<LongestCycle> cycle =
        LongestCycle::create(plan, shape,
                             {.known_answer_mesh = kKnownAnswerMesh,
                              .memory_bytes = 0,
                              .is_float_only = plan.lists[0].rechecks == 0,
                              .asks_first_part = asks_first_part(Slides(1).machine, plan)},
                             fault);
    EXPECT_TRUE(cycle) << fault;
    return cycle;
}

WorkLists of_groups(const WorkLists& lists, std::uint32_t groups) {
    const WorkLists share = share_of(lists, groups);
    return {share.node_pairs * groups, share.leaf_pairs * groups, share.box_rows * groups,
            share.triangle_pairs * groups, share.rechecks * groups};
}

/// Of the second of three stages: its two parts, as far as their groups share them.
WorkLists most_of_levels(const CyclePlan& plan, const CycleShape& shape) {
    WorkLists most = of_groups(lists_of_whole_boxes(plan), shape.open);
    if (plan.queries[1] / shape.kept >= 2) {
        const WorkLists more = of_groups(lists_of_rounds(plan), shape.kept);
        most = {most.node_pairs + more.node_pairs, most.leaf_pairs + more.leaf_pairs,
                most.box_rows + more.box_rows, most.triangle_pairs + more.triangle_pairs,
                most.rechecks + more.rechecks};
    }
    return most;
}

void expect_full(const CyclePlan& plan, const CycleShape& shape) {
    SCOPED_TRACE(std::string(name_of(shape.layout)) + ", tasks " + std::to_string(shape.tasks) +
                 ", open " + std::to_string(shape.open) + ", kept " + std::to_string(shape.kept) +
                 ", parts " + std::to_string(shape.parts) + ", stages " +
                 std::to_string(plan.stages));
    std::optional<LongestCycle> cycle = cycle_of(plan, shape);
    ASSERT_TRUE(cycle);
    Slides slides(shape.asks_twice ? 2 * shape.tasks : shape.tasks);
    const StagedWork work = slides.prove(*cycle, plan, shape.asks_twice);
    ASSERT_FALSE(cycle->is_other());
    EXPECT_EQ(work.known_answer_signature, kKnownAnswerSignature);
    EXPECT_EQ(work.queries, queries_of(cycle->done()));
    EXPECT_EQ(cycle->done(), cycle->planned());
    const std::uint32_t last_groups = plan.stages == 3 ? shape.kept : shape.open;
    const bool has_first_part = plan.stages > 1 && last_groups == 1 &&
                                plan.lists[0].rechecks == 0 &&
                                cycle->done()[plan.stages - 1].groups == 1;
    const WorkLists first_part = has_first_part ? kFirstPartShare : WorkLists{};
    const WorkLists all = sum_of(cycle->done());
    EXPECT_EQ(work.used,
              (WorkLists{all.node_pairs + first_part.node_pairs,
                         all.leaf_pairs + first_part.leaf_pairs, all.box_rows + first_part.box_rows,
                         all.triangle_pairs + first_part.triangle_pairs, all.rechecks}));
    for (std::uint32_t i = 0; i < plan.stages; ++i) {
        const StageWork& stage = cycle->done()[i];
        if (stage.groups == 0) {  // left out
            continue;
        }
        if (asks_again(i, plan)) {
            EXPECT_EQ(stage.lists, most_of_levels(plan, shape));
            continue;
        }
        const WorkLists share =
            i == 0 ? first_share_of(plan.lists[0], shape.tasks, plan.stages == 1, shape.asks_twice)
                   : share_of(plan.lists[i], stage.groups);
        EXPECT_EQ(stage.lists,
                  (WorkLists{share.node_pairs * stage.groups, share.leaf_pairs * stage.groups,
                             share.box_rows * stage.groups, share.triangle_pairs * stage.groups,
                             share.rechecks * stage.groups}))
            << "stage " << i;
    }
    for (std::uint32_t i = 0; i < slides.results.size(); ++i) {
        EXPECT_EQ(slides.results[i].proof,
                  i < shape.tasks ? JointBoxProof::proven : JointBoxProof::budget_spent);
    }
}

TEST(LongestCycle, FillsEveryListOfEveryStageInEveryLayout) {
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        for (const std::uint32_t tasks : {1U, 2U, 8U, 24U}) {
            const CyclePlan plan = plan_of(stages, tasks, 510, kUsual);
            for (CycleShape shape : cycle_shapes(plan, tasks)) {
                for (const CycleLayout layout : {CycleLayout::even, CycleLayout::heaped,
                                                 CycleLayout::rows, CycleLayout::sparse}) {
                    // The second of three stages has fewer rows than that would take.
                    if (layout != CycleLayout::even || stages < 3) {
                        shape.layout = layout;
                        expect_full(plan, shape);
                    }
                }
            }
        }
    }
}

// With a longer permit that proves nothing the first stage asks of each pair twice.
TEST(LongestCycle, FillsAFirstStageThatAsksTwice) {
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        for (const std::uint32_t tasks : {1U, 8U, 24U}) {
            const CyclePlan plan = plan_of(stages, tasks, 510, kUsual);
            const std::vector<CycleShape> once = cycle_shapes(plan, tasks);
            const std::vector<CycleShape> twice = cycle_shapes(plan, tasks, true);
            ASSERT_EQ(once.size(), twice.size());
            for (std::size_t i = 0; i < twice.size(); ++i) {
                CycleShape shape = twice[i];
                shape.layout = CycleLayout::rows;
                expect_full(plan, shape);
                std::optional<LongestCycle> cycle = cycle_of(plan, shape);
                std::optional<LongestCycle> single = cycle_of(plan, once[i]);
                ASSERT_TRUE(cycle && single);
                EXPECT_EQ(queries_of(cycle->planned()), queries_of(single->planned()) + tasks);
            }
        }
    }
}

TEST(LongestCycle, FillsSmallAndOddListsToo) {
    for (const WorkLists& lists :
         {WorkLists{128, 96, 512, 768, 0}, WorkLists{131, 101, 557, 787, 0},
          WorkLists{2048, 1536, 8192, 12288, 0}}) {
        const CyclePlan plan = plan_of(2, 5, 510, lists);
        for (CycleShape shape : cycle_shapes(plan, 5)) {
            for (const CycleLayout layout :
                 {CycleLayout::even, CycleLayout::rows, CycleLayout::sparse}) {
                shape.layout = layout;
                expect_full(plan, shape);
            }
        }
    }
}

// More pairs of leaves than rows: leaves of b share the row of one of a.
TEST(LongestCycle, FillsStagesWhoseListsHaveShapesOfTheirOwn) {
    CyclePlan plan{.stages = 3};
    plan.queries = {24, 32, 512};
    plan.lists = {{{32, 24, 128, 192, 0}, {96, 288, 384, 2304, 0}, {384, 72, 1536, 576, 0}}};
    for (CycleShape shape : cycle_shapes(plan, 8)) {
        for (const CycleLayout layout :
             {CycleLayout::heaped, CycleLayout::rows, CycleLayout::sparse}) {
            shape.layout = layout;
            expect_full(plan, shape);
        }
    }
}

TEST(LongestCycle, FillsWholeTrees) {
    CyclePlan plan = plan_of(2, 8, 510, kUsual);
    plan.form = TreeForm::whole;
    expect_full(plan, {.layout = CycleLayout::rows, .tasks = 8, .open = 3});
}

TEST(LongestCycle, FillsRechecksThatDoubleProvesApart) {
    WorkLists lists = kUsual;
    lists.rechecks = 256;
    const CyclePlan plan = plan_of(2, 8, 510, lists);
    expect_full(plan, {.layout = CycleLayout::even, .tasks = 8, .open = 4});
}

// A cycle that was short by one would not notice.
TEST(LongestCycle, OnePlaceLessInAnyListLosesItsGroup) {
    using List = std::uint32_t WorkLists::*;
    // Whole batches of triangles in each stage: one place less costs one.
    const CyclePlan plan = plan_of(2, 8, 510, {512, 384, 2048, 4096, 0});
    std::optional<LongestCycle> cycle =
        cycle_of(plan, {.layout = CycleLayout::rows, .tasks = 8, .open = 1});
    for (const std::uint32_t stage : {0U, 1U}) {
        for (const List list : {&WorkLists::node_pairs, &WorkLists::leaf_pairs,
                                &WorkLists::box_rows, &WorkLists::triangle_pairs}) {
            CyclePlan shorter = plan;
            shorter.lists[stage].*list -= 1;
            Slides slides(8);
            static_cast<void>(slides.prove(*cycle, shorter));
            EXPECT_TRUE(cycle->is_other() || slides.results[0].proof != JointBoxProof::proven)
                << "stage " << stage;
        }
    }
}

TEST(LongestCycle, AnOverflowingOneIsStoppedAtTheLastPlace) {
    const CyclePlan plan = plan_of(2, 8, 510, kUsual);
    std::optional<LongestCycle> cycle =
        cycle_of(plan, {.layout = CycleLayout::overflowing, .tasks = 8});
    Slides slides(8);
    const StagedWork work = slides.prove(*cycle, plan);
    ASSERT_FALSE(cycle->is_other());
    EXPECT_EQ(work.stages, 2U);
    for (const JointBoxResult& result : slides.results) {
        EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
        EXPECT_TRUE(is_overflow(result.status));
    }
}

TEST(LongestCycle, SaysWhatDoesNotGoTogether) {
    std::string fault;
    const CyclePlan plan = plan_of(2, 8, 510, {512, 512, 512, 4096, 0});
    EXPECT_FALSE(LongestCycle::create(plan, {.tasks = 8}, {}, fault));
    EXPECT_NE(fault.find("box_rows"), std::string::npos);
}

TEST(LongestCycle, NoticesACycleThatItWasNotMadeFor) {
    const CyclePlan plan = plan_of(2, 8, 510, kUsual);
    std::optional<LongestCycle> cycle = cycle_of(plan, {.tasks = 8});
    Slides slides(7);
    static_cast<void>(slides.prove(*cycle, plan));
    EXPECT_TRUE(cycle->is_other());
}

}  // namespace
}  // namespace axg
