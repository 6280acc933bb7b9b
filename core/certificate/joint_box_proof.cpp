// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/joint_box_proof.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/base/assert.hpp"
#include "core/certificate/box_queries.hpp"
#include "core/certificate/travel.hpp"
#include "core/collision/known_answer.hpp"
#include "core/machine/cycle_plan.hpp"

namespace axg {

namespace {

/// Checks only the axes of the pair's path.
bool is_in_box(const Machine& machine, const JointPath& path, const JointBox& box,
               std::span<const double> position) noexcept {
    bool inside = true;
    for (std::uint32_t k = 0; inside && k < path.count; ++k) {
        const std::uint32_t axis = machine.bodies[path.body[k]].joint.axis;
        inside = std::fabs(position[axis] - box.centre[axis]) <= box.half[axis];  // NaN fails
    }
    return inside;
}

}  // namespace

bool may_help_to_split(QueryStatus status, double r_mm) noexcept {
    switch (status) {
        case QueryStatus::ok:
        case QueryStatus::too_many_node_pairs:
        case QueryStatus::too_many_triangle_pairs:
        case QueryStatus::too_many_rechecks:
        case QueryStatus::too_many_leaf_pairs:
        case QueryStatus::too_many_box_rows:
            return true;
        case QueryStatus::bad_query:
            return r_mm > kMarginMmMax;
        case QueryStatus::not_run:
        case QueryStatus::bad_rounding:
            break;
    }
    return false;
}

bool is_pruned_for(const Machine& machine, const JointBoxTask& task, const JointBox& box) noexcept {
    return task.margin_mm <= task.pruned.up_to_mm && is_in_travel(machine, task.path, box);
}

void halve(JointBox& box, std::uint32_t axis, bool is_upper, const JointBox& grid) noexcept {
    const double quarter = 0.5 * box.half[axis];
    const double centre = box.centre[axis];
    box.centre[axis] = is_upper ? centre + quarter : centre - quarter;
    // Rounding may move the centre by half a unit in its last place; no centre is outside the grid.
    box.half[axis] = quarter + 0x1p-52 * (std::fabs(grid.centre[axis]) + grid.half[axis]);
}

JointBox half_of(const JointBox& box, std::uint32_t axis, bool is_upper,
                 const JointBox& grid) noexcept {
    JointBox out = box;
    halve(out, axis, is_upper, grid);
    return out;
}

PlacedPair placed_pair(const JointBoxTask& task, std::span<const Pose> moved) noexcept {
    return {{task.extent_a, compose(moved[task.body_a], task.at_a)},
            {task.extent_b, compose(moved[task.body_b], task.at_b)}};
}

Query query_of(const JointBoxTask& task, const PlacedPair& pair, double r_mm) noexcept {
    Query q;
    q.mesh_a = task.mesh_a;
    q.mesh_b = task.mesh_b;
    q.r_mm = r_mm;
    q.pose_error_mm = task.pose_error_mm;
    q.pose = relative_pose(pair.a.placed, pair.b.placed);
    return q;
}

ApartPose apart_pose_in(const Machine& machine, const JointBoxTask& task,
                        const JointBoxResult& result, std::span<const double> position,
                        std::span<const Pose> moved) noexcept {
    const JointBox& box = task.pieces.empty() ? task.box : task.pieces[task.pieces.size() / 2];
    if (result.proof != JointBoxProof::proven || !is_in_box(machine, task.path, box, position)) {
        return {};
    }
    const Query query = query_of(task, placed_pair(task, moved), task.margin_mm);
    const bool is_pruned = is_pruned_for(machine, task, box);
    return {.is_proven = true,
            .mesh_a = is_pruned ? task.pruned.mesh_a : query.mesh_a,
            .mesh_b = is_pruned ? task.pruned.mesh_b : query.mesh_b,
            .pose_error_mm = query.pose_error_mm,
            .pose = query.pose};
}

std::optional<JointBoxProver> JointBoxProver::create(const Machine& machine, std::uint32_t tasks,
                                                     const JointBoxBudget& budget) {
    const std::uint32_t count = std::max(tasks, budget.queries);
    Arena arena(2 * Arena::size_bytes<BoxItem>(count) + Arena::size_bytes<Query>(count + 2) +
                Arena::size_bytes<QueryResult>(count + 2) + BoxQueries::size_bytes(count) +
                Arena::size_bytes<BoxQueries>(1));
    if (!arena.ok()) {
        return std::nullopt;
    }
    JointBoxProver prover(budget, std::move(arena));
    prover.items_ = prover.arena_.take<BoxItem>(count);
    prover.next_ = prover.arena_.take<BoxItem>(count);
    prover.queries_ = prover.arena_.take<Query>(count + 2);
    prover.query_results_ = prover.arena_.take<QueryResult>(count + 2);
    BoxQueries* const place = prover.arena_.take<BoxQueries>(1).data();
    prover.boxes_ = std::construct_at(
        place, machine, count, lists_of(cycle_plan(machine, tasks)).rechecks == 0, prover.arena_);
    prover.arena_.seal();
    return prover;
}

void JointBoxProver::run(const Engine& engine, std::uint32_t count, JointBoxWork& work) noexcept {
    const bool has_known_answer = budget_.known_answer_mesh != kNoIndex;
    const std::uint32_t all = count + (has_known_answer ? 2U : 0U);
    if (has_known_answer) {
        queries_[count] = known_answer_query(budget_.known_answer_mesh, false);
        queries_[count + 1] = known_answer_query(budget_.known_answer_mesh, true);
    }
    std::fill_n(query_results_.begin(), all,
                QueryResult{});  // an engine that is silent has proven nothing
    engine(queries_.first(all), query_results_.first(all));
    if (has_known_answer) {
        const QueryResult &far = query_results_[count], &near = query_results_[count + 1];
        const bool is_lost = engine.run_groups == nullptr && is_batch_lost(far, near);
        if (is_lost) {  // no other result is valid
            std::fill_n(query_results_.begin(), count, far);
        }
        const std::uint16_t seen =
            is_lost ? kKnownAnswerSignature : known_answer_signature(far, near);
        work.known_answer_signature =
            work.rounds == 0 || work.known_answer_signature == seen ? seen : 0;
    }
    ++work.rounds;
    work.queries += count;
}

/// Evaluates the results of a round and splits unproven boxes for the next. Returns the number of
/// boxes in the next round.
std::uint32_t JointBoxProver::split(std::span<const JointBoxTask> tasks,
                                    std::span<JointBoxResult> results,
                                    std::uint32_t count) noexcept {
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const BoxItem& item = items_[i];
        const QueryResult& query_result = query_results_[i];
        JointBoxResult& result = results[item.task];
        ++result.queries;
        if (query_result.proof == Proof::far && query_result.status == QueryStatus::ok) {
            continue;
        }
        if (result.proof != JointBoxProof::proven) {
            continue;  // the task has already failed
        }
        result.status = query_result.status;
        if (!may_help_to_split(query_result.status, queries_[i].r_mm)) {
            result = {JointBoxProof::engine_failed, query_result.status, result.queries, item.box};
            continue;
        }
        if (item.widest_axis == kNoIndex || next + 2 > next_.size()) {
            result = {JointBoxProof::budget_spent, query_result.status, result.queries, item.box};
            continue;
        }
        for (const bool is_upper : {false, true}) {
            boxes_->halve(tasks[item.task], item, is_upper, next_[next]);
            next += boxes_->is_proven_already(tasks[item.task], next_[next].box) ? 0 : 1;
        }
    }
    return next;
}

/// Discards the boxes of tasks that have failed.
std::uint32_t JointBoxProver::drop_given_up(std::span<const JointBoxResult> results,
                                            std::uint32_t count) noexcept {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (results[items_[i].task].proof == JointBoxProof::proven) {
            items_[kept++] = items_[i];
        }
    }
    return kept;
}

JointBoxWork JointBoxProver::prove(const Engine& engine, std::span<const JointBoxTask> tasks,
                                   std::span<JointBoxResult> results,
                                   const JointBoxSpend& spend) noexcept {
    AXG_ASSERT(results.size() >= tasks.size());
    AXG_ASSERT(tasks.size() <= items_.size());
    const std::uint32_t rounds = std::min(budget_.rounds, spend.rounds);
    const std::uint32_t queries = std::min(budget_.queries, spend.queries);
    std::uint32_t count = boxes_->find_roots(tasks, results, items_);
    JointBoxWork work;
    if (count == 0 && budget_.known_answer_mesh != kNoIndex) {
        run(engine, 0, work);  // detects a broken engine in a cycle without pairs, too
    }
    while (count != 0) {
        if (work.rounds == rounds || count > queries - work.queries) {
            for (std::uint32_t i = 0; i < count; ++i) {
                JointBoxResult& result = results[items_[i].task];
                if (result.proof == JointBoxProof::proven) {
                    result.proof = JointBoxProof::budget_spent;
                    result.open = items_[i].box;
                }
            }
            return work;
        }
        boxes_->pose(tasks, items_.first(count), queries_.first(count));
        run(engine, count, work);
        count = split(tasks, results, count);
        std::swap(items_, next_);
        count = drop_given_up(results, count);
    }
    return work;
}

}  // namespace axg
