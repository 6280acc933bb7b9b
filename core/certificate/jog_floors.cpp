// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/jog_floors.hpp"

#include <algorithm>
#include <array>

#include "core/machine/kinematics.hpp"

namespace axg {
namespace {

std::uint32_t slots_of(const Machine& machine) noexcept {
    return machine.guard.jog.is_promised ? stop_tasks(machine) : 0;
}

std::uint32_t rungs_of(const Machine& machine, const CyclePlan& plan) noexcept {
    const std::uint32_t slots = slots_of(machine);
    return std::max(slots, std::min(slots, jog_ladders(plan)) * kJogRungs);
}

}  // namespace

std::size_t JogFloors::size_bytes(const Machine& machine, const CyclePlan& plan) noexcept {
    const std::uint32_t slots = slots_of(machine), rungs = rungs_of(machine, plan);
    return Arena::size_bytes<Floor>(slots) + Arena::size_bytes<std::uint32_t>(slots) +
           Arena::size_bytes<Query>(rungs) + Arena::size_bytes<QueryResult>(rungs) +
           Arena::size_bytes<GroupWork>(slots);
}

JogFloors::JogFloors(const Machine& machine, const CyclePlan& plan, Arena& arena) noexcept
    : machine_(&machine),
      plan_(plan),
      floors_(arena.take<Floor>(slots_of(machine))),
      below_(arena.take<std::uint32_t>(floors_.size())),
      queries_(arena.take<Query>(rungs_of(machine, plan))),
      results_(arena.take<QueryResult>(queries_.size())),
      groups_(arena.take<GroupWork>(floors_.size())) {
    for (Floor& floor : floors_) {
        floor.kept_mm = kNoJogFloor;
    }
}

void JogFloors::note(const SampledMotion& motion, bool is_first) noexcept {
    std::array<SampleErrors, kAxesMax> errors;
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        errors[i] = motion.errors_of(i);
    }
    const JogMove before = move();
    has_left_ = !watch_.note(*machine_, motion.snapshot(), errors, is_first);
    has_floors_ = has_floors_ && !is_first && is_on() && move() == before;
    for (std::size_t i = 0; is_first && i < floors_.size(); ++i) {
        floors_[i].kept_mm = kNoJogFloor;
    }
}

bool JogFloors::apply(const Engine& engine, const SampledMotion& motion,
                      PairTasks& tasks) noexcept {
    if (!has_floors_ || found_at_ == motion.snapshot().sample) {
        find(engine, motion, tasks);
        begins_ = has_floors_;
        return false;
    }
    for (std::uint32_t i = 0; i < tasks.count(); ++i) {
        tasks.tasks()[i].margin_mm = floors_[tasks.slot_of(i)].mm;
    }
    return has_floors_;
}

/// Determines each pair's floor at the start of a jog; it applies to the jog's end.
void JogFloors::find(const Engine& engine, const SampledMotion& motion,
                     const PairTasks& tasks) noexcept {
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, motion.snapshot().position, moved);
    Placed placed{moved, {.centre = motion.snapshot().position, .half = {}}};
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        placed.errors.half[i] = motion.held_error(i);
    }
    has_floors_ = true;
    found_at_ = motion.snapshot().sample;
    for (std::uint32_t i = 0; i < tasks.count(); ++i) {
        pose_rungs(tasks, i, placed, 0, queries_.subspan(i, 1));
    }
    ask_rungs(engine, tasks.count(), 1, jog_lists(plan_).margins);
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < tasks.count(); ++i) {
        const bool is_kept =
            results_[i].status == QueryStatus::ok && results_[i].proof == Proof::far;
        floors_[tasks.slot_of(i)].mm = tasks.tasks()[i].margin_mm;
        if (!is_kept) {
            below_[open++] = i;
        }
    }
    if (open > jog_ladders(plan_)) {  // too many pairs nearer than their margins
        has_floors_ = false;
    } else if (open != 0) {
        find_lower(engine, placed, tasks, open);
    }
}

/// Queries all rungs below the margin at once, for the pairs nearer than their margin.
void JogFloors::find_lower(const Engine& engine, const Placed& placed, const PairTasks& tasks,
                           std::uint32_t open) noexcept {
    constexpr std::uint32_t kBelow = kJogRungs - 1;
    for (std::uint32_t i = 0; i < open; ++i) {
        pose_rungs(tasks, below_[i], placed, 1, queries_.subspan(i * kBelow, kBelow));
    }
    ask_rungs(engine, open, kBelow, jog_lists(plan_).rungs);
    for (std::uint32_t i = 0; i < open; ++i) {
        take_floor(tasks, below_[i], placed.errors, results_.subspan(i * kBelow, kBelow));
    }
}

/// Makes one query for each rung from `first` down, at the present positions.
void JogFloors::pose_rungs(const PairTasks& tasks, std::uint32_t task, const Placed& placed,
                           std::uint32_t first, std::span<Query> out) const noexcept {
    const JointBoxTask& of = tasks.tasks()[task];
    const PlacedPair pair = placed_pair(of, placed.moved);
    const double errors_mm =
        motion_along(*machine_, of.path, placed.moved, pair.a, pair.b, placed.errors).total_mm;
    const auto rungs = jog_ladder(of.margin_mm, floor_before(tasks, task, placed.errors));
    for (std::uint32_t i = 0; i < out.size(); ++i) {
        out[i] = query_of(of, pair, jog_rung_query_mm(rungs[first + i], errors_mm));
        out[i].is_float_only = lists_of(plan_).rechecks == 0;
    }
}

/// Runs `rungs` queries of each pair, stored in order; each pair is a group.
void JogFloors::ask_rungs(const Engine& engine, std::uint32_t pairs, std::uint32_t rungs,
                          const WorkLists& lists) noexcept {
    if (pairs == 0) {
        return;
    }
    const std::span<Query> queries = queries_.first(pairs * rungs);
    const std::span<QueryResult> results = results_.first(pairs * rungs);
    for (std::uint32_t i = 0; i < queries.size(); ++i) {
        queries[i].group = static_cast<std::uint16_t>(i / rungs);
    }
    std::fill_n(groups_.begin(), pairs, GroupWork{.share = share_of(lists, pairs)});
    std::fill(results.begin(), results.end(), QueryResult{});
    engine(queries, results, groups_.first(pairs));
}

/// Sets the floor to the highest proven rung below the margin. If no query ran to its end, the pair
/// has no floor.
void JogFloors::take_floor(const PairTasks& tasks, std::uint32_t task, const JointBox& placed,
                           std::span<const QueryResult> rungs) noexcept {
    const double before_mm = floor_before(tasks, task, placed);
    const double margin_mm = tasks.tasks()[task].margin_mm;
    double& floor_mm = floors_[tasks.slot_of(task)].mm;
    floor_mm = std::max(0.0, std::min(before_mm, margin_mm));
    bool is_known = false;
    for (std::size_t i = rungs.size(); i-- > 0;) {
        const bool is_tested = rungs[i].status == QueryStatus::ok;
        is_known = is_known || is_tested;
        if (is_tested && rungs[i].proof == Proof::far) {
            floor_mm = jog_ladder(margin_mm, before_mm)[i + 1];
        }
    }
    has_floors_ = has_floors_ && is_known;
}

/// The last jog's floor if the axes are still in the box of its certificate. No permit can have led
/// them out of it: a person moved a machine that is outside.
double JogFloors::floor_before(const PairTasks& tasks, std::uint32_t task,
                               const JointBox& placed) const noexcept {
    const Floor& floor = floors_[tasks.slot_of(task)];
    const bool holds =
        floor.kept_mm != kNoJogFloor &&
        is_in_box_any_turn(*machine_, tasks.tasks()[task].path, floor.box, placed.centre);
    return holds ? floor.kept_mm : kNoJogFloor;
}

void JogFloors::keep(std::uint32_t slot, const JointBox& box) noexcept {
    if (slot < floors_.size()) {
        floors_[slot].kept_mm = is_on() ? floors_[slot].mm : kNoJogFloor;
        floors_[slot].box = box;
    }
}

}  // namespace axg
