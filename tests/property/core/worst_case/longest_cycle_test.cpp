// SPDX-License-Identifier: Apache-2.0
// Random cycles over random bodies against the constructed longest cycle of the same plan: none has
// more queries, none has more counted work in any list of any stage, and the engine stops at the
// entry that is one too many. AXG_COUNT: cycles.
#include "core/worst_case/longest_cycle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <vector>

#include "core/certificate/staged_proof.hpp"
#include "core/collision/known_answer.hpp"
#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kTasks = 3, kBodies = 4, kPlans = 24;
using List = std::uint32_t WorkLists::*;
constexpr std::array<List, 5> kLists{&WorkLists::node_pairs, &WorkLists::leaf_pairs,
                                     &WorkLists::box_rows, &WorkLists::triangle_pairs,
                                     &WorkLists::rechecks};
// Of each list, what may be counted at once: triangles of two leaves; else one.
constexpr std::array<std::uint32_t, 5> kSteps{1, 1, 1, kNodeWidth* kNodeWidth, 1};

/// The most that constructed cycles of a plan do in each stage, whatever the layout and the groups.
/// Empty: its lists do not go together, and no guard starts with it.
std::optional<CycleWork> most_of(const CyclePlan& plan) {
    CycleWork most{};
    for (CycleShape shape : cycle_shapes(plan, kTasks)) {
        std::string fault;
        shape.layout = CycleLayout::rows;
        const auto cycle = LongestCycle::create(
            plan, shape, {.is_float_only = plan.lists[0].rechecks == 0}, fault);
        if (!cycle) {
            EXPECT_EQ(fault.find("the lists of the plan do not go together"), 0U) << fault;
            return std::nullopt;
        }
        for (std::size_t i = 0; i < most.size(); ++i) {
            most[i].queries = std::max(most[i].queries, cycle->planned()[i].queries);
            for (const List list : kLists) {
                most[i].lists.*list =
                    std::max(most[i].lists.*list, cycle->planned()[i].lists.*list);
            }
        }
    }
    return most;
}

/// Passes queries on, and holds what they come to against the constructed cycle.
struct Watch {
    Engine engine;
    CyclePlan plan{};
    CycleWork most{};
    std::uint32_t stage = 0;  // of the last call
    StageWork done{};         // in it so far
    std::uint64_t more_queries = 0, more_work = 0, ran_on = 0, full = 0, first_parts = 0;
    double nearest = 0;  // the largest share of the constructed work, all lists together

    static void run(void* self, std::span<const Query> queries, std::span<QueryResult> results,
                    std::span<GroupWork> groups) noexcept {
        Watch& watch = *static_cast<Watch*>(self);
        std::vector<WorkLists> before;
        for (const GroupWork& group : groups) {
            before.push_back(group.used);
        }
        watch.engine(queries, results, groups);
        if (groups.size() == 1) {  // the first part alone: a share of its own
            const GroupWork& group = groups[0];
            ++watch.first_parts;
            watch.more_queries += queries.size() == 1 && group.share == kFirstPartShare ? 0 : 1;
            for (std::size_t i = 0; i < kLists.size(); ++i) {
                watch.ran_on += group.used.*kLists[i] > group.share.*kLists[i] + kSteps[i] ? 1 : 0;
            }
            return;
        }
        const auto count = static_cast<std::uint32_t>(groups.size() - 1);
        while (count != 0 && watch.stage + 1 < watch.plan.stages &&
               (watch.is_first_over() ||
                !is_of_stage(watch.plan, watch.stage, groups[0].share, count))) {
            ++watch.stage;  // it is over, or was left out for want of queries
            watch.done = {};
        }
        const StageWork& most = watch.most[watch.stage];
        watch.done.queries += static_cast<std::uint32_t>(queries.size()) - 2;
        watch.more_queries += watch.done.queries > most.queries ? 1 : 0;
        double done_sum = 0, most_sum = 0;
        for (std::size_t i = 0; i < kLists.size(); ++i) {
            for (std::size_t group = 0; group < count; ++group) {
                const std::uint32_t used = groups[group].used.*kLists[i],
                                    share = groups[group].share.*kLists[i];
                watch.done.lists.*kLists[i] +=
                    std::min(used, share) - std::min(before[group].*kLists[i], share);
                watch.ran_on += used > share + kSteps[i] ? 1 : 0;
                watch.full += used > share && before[group].*kLists[i] <= share ? 1 : 0;
            }
            watch.more_work += watch.done.lists.*kLists[i] > most.lists.*kLists[i] ? 1 : 0;
            done_sum += watch.done.lists.*kLists[i];
            most_sum += most.lists.*kLists[i];
        }
        watch.nearest = std::max(watch.nearest, done_sum / std::max(most_sum, 1.0));
    }
    /// The first stage is one call. A share of the second may be equal to that of the first.
    [[nodiscard]] bool is_first_over() const { return stage == 0 && done.queries != 0; }
    /// Whether calls of a stage have such a share: the second of three deals its lists twice.
    static bool is_of_stage(const CyclePlan& plan, std::uint32_t stage, const WorkLists& share,
                            std::uint32_t groups) {
        return asks_again(stage, plan) ? share_of(plan.lists[2], groups) != share
                                       : share_of(plan.lists[stage], groups) == share;
    }
    Engine watched() { return {.self = this, .run = nullptr, .run_groups = run}; }
};

/// Bodies past which others slide, and the boxes of one cycle.
class RandomCycles {
  public:
    RandomCycles() {
        test::Draw draw(7);
        for (const std::uint32_t n : {2U, 4U, 6U, 9U}) {
            meshes_.push_back(test::lumpy_ball(draw, n, 30, 0.4));
        }
        meshes_.push_back(known_answer_mesh());
        engine_.emplace(*test::engine_over(meshes_));
        machine_.axes.resize(1);
        machine_.bodies.resize(2);
        machine_.bodies[1].joint = {0, {1, 0, 0}, {}};
        extent_.radius_mm = 60;
    }
    [[nodiscard]] Engine engine() { return engine_->engine(); }
    [[nodiscard]] StagedProver prover(const CyclePlan& plan) const {
        return std::move(*StagedProver::create(machine_, kTasks, plan, kBodies));
    }
    void draw_cycle(test::Draw& draw) {
        const double near_mm = draw.between(30, 70);
        for (JointBoxTask& task : tasks_) {
            task.body_a = 1;
            task.mesh_a = static_cast<std::uint32_t>(draw.below(kBodies));
            task.mesh_b = static_cast<std::uint32_t>(draw.below(kBodies));
            task.extent_a = task.extent_b = &extent_;
            task.path = path_between(machine_, 1, 0);
            task.margin_mm = draw.between(0, 2);
            task.at_a = test::random_rotation(draw);
            task.at_a.t[1] = near_mm + draw.between(-4, 4);
            task.box.centre[0] = draw.between(-30, 30);
            task.box.half[0] = draw.between(0, 4);
        }
    }
    void prove(StagedProver& prover, const Engine& engine) {
        static_cast<void>(prover.prove(engine, tasks_, results_));
    }

  private:
    std::vector<Mesh> meshes_;
    std::optional<CpuEngine> engine_;
    Machine machine_;
    BodyExtent extent_;
    std::array<JointBoxTask, kTasks> tasks_;
    std::array<JointBoxResult, kTasks> results_;
};

CyclePlan random_plan(test::Draw& draw) {
    const auto unit = static_cast<std::uint32_t>(3 + draw.below(20));
    const auto stages = static_cast<std::uint32_t>(1 + draw.below(3));
    const auto queries = static_cast<std::uint32_t>(8 + draw.below(60));
    return plan_of(stages, kTasks, queries, {4 * unit, 3 * unit, 16 * unit, 24 * unit, 0});
}

TEST(LongestCycleProperty, NoRandomCycleHasMoreCountedWork) {
    const std::uint64_t count = test::count_from_environment(100'000);
    test::Draw draw(test::printed_seed(20261123));
    RandomCycles cycles;
    Watch watch{.engine = cycles.engine()};
    std::uint32_t plans = 0;
    for (std::uint32_t drawn = 0; drawn < 20 * kPlans && plans < kPlans; ++drawn) {
        const CyclePlan plan = random_plan(draw);
        const std::optional<CycleWork> most = most_of(plan);
        if (!most) {
            continue;
        }
        ++plans;
        watch.plan = plan;
        watch.most = *most;
        StagedProver prover = cycles.prover(plan);
        for (std::uint64_t cycle = 0; cycle < count / kPlans; ++cycle) {
            cycles.draw_cycle(draw);
            watch.stage = 0;
            watch.done = {};
            cycles.prove(prover, watch.watched());
        }
    }
    EXPECT_EQ(plans, kPlans);
    EXPECT_EQ(watch.more_queries, 0U);
    EXPECT_EQ(watch.more_work, 0U);
    EXPECT_EQ(watch.ran_on, 0U);
    EXPECT_GT(watch.first_parts, count / 200);
    EXPECT_GT(watch.full, count / 100) << "lists that nothing fills prove nothing";
    EXPECT_GT(watch.nearest, 0.5);
    std::printf("%llu cycles, %llu lists too short, at most %.2f of the constructed work\n",
                static_cast<unsigned long long>(count / kPlans * kPlans),
                static_cast<unsigned long long>(watch.full), watch.nearest);
}

}  // namespace
}  // namespace axg
