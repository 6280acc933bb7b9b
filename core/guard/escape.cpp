// SPDX-License-Identifier: Apache-2.0
#include "core/guard/escape.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/assert.hpp"
#include "core/collision/known_answer.hpp"
#include "core/machine/kinematics.hpp"
#include "core/reach/jog.hpp"

namespace axg {

namespace {

PathMotion motion_in(const Machine& machine, const JointBoxTask& task,
                     const JointBox& box) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(machine, box.centre, moved);
    const PlacedPair pair = placed_pair(task, moved);
    return motion_along(machine, task.path, moved, pair.a, pair.b, box);
}

bool is_moved_by(const Machine& machine, const JointBoxTask& task, std::uint32_t axis) noexcept {
    const auto* const end = task.path.body.begin() + task.path.count;
    return std::any_of(task.path.body.begin(), end,
                       [&](std::uint32_t body) { return machine.bodies[body].joint.axis == axis; });
}

/// Returns the box of all positions that the axes may have, by the snapshot and its errors.
JointBox box_of_errors(const Machine& machine, const StopCertificate& certificate) noexcept {
    JointBox box{.centre = certificate.snapshot().position, .half = {}};
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        box.half[i] = certificate.held_error(i);
    }
    return box;
}

double clearance_of(const QueryResult& query_result) noexcept {
    return query_result.status == QueryStatus::ok && query_result.proof == Proof::far
               ? query_result.clearance_mm
               : 0;
}

}  // namespace

std::optional<EscapeFinder> EscapeFinder::create(const Machine& machine) {
    const std::uint32_t tasks = stop_tasks(machine);
    auto prover = JointBoxProver::create(machine, tasks,
                                         {.rounds = kEscapeRounds,
                                          .queries = kEscapeQueries,
                                          .known_answer_mesh = known_answer_mesh_index(machine)});
    Arena arena(Arena::size_bytes<Query>(tasks) + Arena::size_bytes<QueryResult>(tasks) +
                Arena::size_bytes<JointBoxTask>(tasks) + Arena::size_bytes<JointBoxResult>(tasks) +
                Arena::size_bytes<double>(tasks));
    if (!prover || !arena.ok()) {
        return std::nullopt;
    }
    EscapeFinder finder(machine, std::move(*prover), std::move(arena));
    finder.queries_ = finder.arena_.take<Query>(tasks);
    finder.query_results_ = finder.arena_.take<QueryResult>(tasks);
    finder.tasks_ = finder.arena_.take<JointBoxTask>(tasks);
    finder.results_ = finder.arena_.take<JointBoxResult>(tasks);
    finder.floors_ = finder.arena_.take<double>(tasks);
    finder.arena_.seal();
    return finder;
}

void EscapeFinder::query_clearances(const Engine& engine, std::span<const JointBoxTask> tasks,
                                    std::span<const double> position, double within_mm) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, position, moved);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        queries_[i] = query_of(tasks[i], placed_pair(tasks[i], moved), within_mm);
        queries_[i].kind = QueryKind::clearance;
        query_results_[i] = QueryResult{};
    }
    engine(queries_.first(tasks.size()), query_results_.first(tasks.size()));
}

/// Queries the clearance of each pair at the current position, and computes its floor.
void EscapeFinder::judge_now(const Engine& engine, const ContainmentTest& containment_test,
                             const StopCertificate& certificate, Escapes& out) noexcept {
    const std::span<const JointBoxTask> tasks = certificate.tasks();
    const std::span<const PairProof> proofs = certificate.cycle().proofs;
    const JointBox errors = box_of_errors(*machine_, certificate);
    query_clearances(engine, tasks, certificate.snapshot().position, kEscapeWithinMm);
    out.is_clear = true;
    out.clearance_mm = kEscapeWithinMm;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        ContainmentResult inside;
        containment_test.run({&queries_[i], 1}, {&query_results_[i], 1}, {&inside, 1});
        out.is_clear = out.is_clear && inside.containment == Containment::none;
        const double clearance_mm = clearance_of(query_results_[i]);
        floors_[i] = jog_floor_mm(tasks[i].margin_mm, clearance_mm,
                                  motion_in(*machine_, tasks[i], errors).total_mm);
        if (clearance_mm < out.clearance_mm) {
            out.clearance_mm = clearance_mm;
            out.pair = proofs[i].pair;
        }
    }
}

/// Whether every pair is proven beyond its floor on the whole way, errors of position included.
bool EscapeFinder::is_way_proven(const Engine& engine, const StopCertificate& certificate,
                                 std::uint32_t axis, double target) noexcept {
    JointBox box = box_of_errors(*machine_, certificate);
    const double way = target - box.centre[axis];
    box.centre[axis] += 0.5 * way;
    // The middle is rounded.
    box.half[axis] += 0.5 * std::fabs(way) + 0x1p-50 * std::fabs(target);
    const std::size_t count = certificate.tasks().size();
    for (std::size_t i = 0; i < count; ++i) {
        tasks_[i] = certificate.tasks()[i];
        tasks_[i].margin_mm = floors_[i];
        tasks_[i].box = box;
        tasks_[i].pieces = {};
    }
    const JointBoxWork work = prover_.prove(engine, tasks_.first(count), results_.first(count));
    return work.known_answer_signature == kKnownAnswerSignature &&
           std::all_of(results_.begin(), results_.begin() + static_cast<std::ptrdiff_t>(count),
                       [](const JointBoxResult& r) { return r.proof == JointBoxProof::proven; });
}

void EscapeFinder::try_jog(const Engine& engine, const StopCertificate& certificate, EscapeJog jog,
                           Escapes& out) noexcept {
    const Axis& axis = machine_->axes[jog.axis];
    const double step = axis.kind == AxisKind::rotary ? kEscapeStepRad : kEscapeStepMm;
    const auto& from = certificate.snapshot().position;
    const double target = from[jog.axis] + (jog.is_negative ? -step : step);
    if (!axis.unlimited && (target < axis.min || target > axis.max)) {
        return;
    }
    // No pair gains more than the step can move it: larger clearances are of no interest.
    JointBox whole{.centre = from, .half = {}};
    whole.half[jog.axis] = step;
    double most_mm = 0;
    for (const JointBoxTask& task : certificate.tasks()) {
        most_mm = std::max(most_mm, motion_in(*machine_, task, whole).total_mm);
    }
    auto to = from;
    to[jog.axis] = target;
    const std::size_t count = certificate.tasks().size();
    query_clearances(engine, certificate.tasks(), to,
                     std::min(out.clearance_mm + most_mm, kMarginMmMax));
    jog.clearance_mm = HUGE_VAL;
    for (std::size_t i = 0; i < count; ++i) {
        jog.clearance_mm = std::min(jog.clearance_mm, clearance_of(query_results_[i]));
    }
    if (jog.clearance_mm < out.clearance_mm + kEscapeGainMm ||
        !is_way_proven(engine, certificate, jog.axis, target)) {
        return;
    }
    EscapeJog* const end = out.jogs.data() + out.count;
    EscapeJog* const place = std::find_if(out.jogs.data(), end, [&](const EscapeJog& other) {
        return other.clearance_mm < jog.clearance_mm;
    });
    std::move_backward(place, end, end + 1);
    *place = jog;
    ++out.count;
}

Escapes EscapeFinder::find(const Engine& engine, const ContainmentTest& containment_test,
                           const StopCertificate& certificate) noexcept {
    Escapes out;
    const std::span<const JointBoxTask> tasks = certificate.tasks();
    AXG_ASSERT(tasks.size() <= queries_.size());
    if (certificate.cycle().status != SnapshotStatus::ok) {
        return out;
    }
    judge_now(engine, containment_test, certificate, out);
    if (!out.is_clear || out.pair == kNoIndex) {
        return out;
    }
    for (std::uint32_t axis = 0; axis < machine_->axes.size(); ++axis) {
        // Only an axis between its two bodies gives the nearest pair more clearance.
        const bool may_gain =
            std::any_of(tasks.begin(), tasks.end(), [&](const JointBoxTask& task) {
                return certificate.cycle()
                               .proofs[static_cast<std::size_t>(&task - tasks.data())]
                               .pair == out.pair &&
                       is_moved_by(*machine_, task, axis);
            });
        for (const bool is_negative : {false, true}) {
            if (may_gain) {
                try_jog(engine, certificate, {axis, is_negative, 0}, out);
            }
        }
    }
    return out;
}

}  // namespace axg
