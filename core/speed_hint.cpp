// SPDX-License-Identifier: Apache-2.0
#include "core/speed_hint.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/assert.hpp"
#include "core/kinematics.hpp"
#include "core/speed_cap.hpp"

namespace axg {

double cap_lead_seconds(const Machine& machine) noexcept {
    double half_turn_s = 0;
    for (const Axis& axis : machine.axes) {
        half_turn_s = std::max(half_turn_s, axis.acceleration_max / axis.jerk_max);
    }
    return machine.guard.cap_lead_s + half_turn_s;
}

namespace {

constexpr std::uint32_t kAccelerations = 8;  // looked at between 0 and the largest
constexpr std::uint32_t kCapStep = 8;        // a cap may rise to twice its value and this

/// How far an axis gets that obeys a cap of `speed`. Below it the axis may still be speeding up,
/// with an acceleration that its jerk can take back before the cap: the less speed, the more of it.
double capped_distance(const AxisLimits& limits, const AxisRange& now, double speed, double free_s,
                       bool is_jerk_limited) noexcept {
    // A later sample will know the speed no worse than this one does.
    const double slack = now.speed_high - now.speed_low + 2 * kPeriodShare * speed;
    if (!is_jerk_limited) {
        return forward_reach(limits, speed - slack, speed + slack, free_s);
    }
    const double unknown = now.acceleration_high - now.acceleration_low;
    const double largest =
        std::min(limits.acceleration_max, std::sqrt(2 * limits.jerk_max * speed));
    double distance = 0;
    for (std::uint32_t i = 0; i <= kAccelerations; ++i) {
        const double acceleration = largest * i / kAccelerations;
        const double at = speed - 0.5 * acceleration * acceleration / limits.jerk_max;
        distance = std::max(distance, forward_reach(limits, at - slack, at + slack, free_s,
                                                    acceleration + unknown));
    }
    return distance;
}

using AxisRanges = std::array<AxisRange, kAxesMax>;

AxisRanges ranges_of(const Machine& machine, const StopPlan& plan) noexcept {
    AxisRanges ranges;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        ranges[i] = plan.now(i);
    }
    return ranges;
}

JointBox capped_box(const Machine& machine, const AxisPicture& picture, const AxisRanges& ranges,
                    double share) noexcept {
    const double free_s = free_seconds(machine);
    const double lead_s = cap_lead_seconds(machine);
    JointBox box;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const AxisRange& now = ranges[i];
        AxisLimits limits = stop_limits(axis);
        // The axis can not follow a cap that falls faster than this.
        limits.stopping_min = std::min(limits.stopping_min, limits.acceleration_max);
        const double speed = share * axis.speed_max;
        const double distance = speed * lead_s + capped_distance(limits, now, speed, free_s,
                                                                 machine.guard.free_jerk_limited);
        const double at = picture.position[i];
        double low = now.low - distance, high = now.high + distance;
        if (machine.guard.travel_enforced && !axis.unlimited) {
            low = std::max(low, std::min(axis.min, now.low));
            high = std::min(high, std::max(axis.max, now.high));
        }
        // The clearance is asked for where the axis is, so the box stays centred there.
        box.centre[i] = at;
        box.half[i] = std::max(high - at, at - low);
    }
    return box;
}

/// The distance that a pair may lose in a box about the positions that `moved` belongs to, and its
/// margin.
double needed_mm(const Machine& machine, const BoxTask& task, std::span<const Pose> moved,
                 const JointBox& box) noexcept {
    const PlacedBody a{task.extent_a, compose(moved[task.body_a], task.at_a)};
    const PlacedBody b{task.extent_b, compose(moved[task.body_b], task.at_b)};
    return task.margin_mm + motion_along(machine, task.path, moved, a, b, box).total_mm;
}

/// As many as a plan has tasks: every pair with every tool.
std::uint32_t tasks_of(const Machine& machine) noexcept {
    return static_cast<std::uint32_t>(machine.pairs.size() *
                                      std::max<std::size_t>(1, machine.tools.size()));
}

}  // namespace

JointBox capped_reach(const Machine& machine, const StopPlan& plan, double share) noexcept {
    return capped_box(machine, plan.picture(), ranges_of(machine, plan), share);
}

std::optional<SpeedHint> SpeedHint::create(const Machine& machine) {
    const std::uint32_t tasks = tasks_of(machine);
    Arena arena(Arena::size_bytes<Question>(tasks) + Arena::size_bytes<Answer>(tasks) +
                Arena::size_bytes<OpenPair>(tasks));
    if (!arena.ok()) {
        return std::nullopt;
    }
    SpeedHint hint(machine, std::move(arena));
    hint.questions_ = hint.arena_.take<Question>(tasks);
    hint.answers_ = hint.arena_.take<Answer>(tasks);
    hint.open_ = hint.arena_.take<OpenPair>(tasks);
    hint.arena_.seal();
    return hint;
}

/// Every pair at a share of rapid. Returns how many are not proven; their questions come first.
std::uint32_t SpeedHint::ask_far(const Engine& engine, const StopPlan& plan,
                                 double share) noexcept {
    const std::span<const BoxTask> tasks = plan.tasks();
    const JointBox box = capped_reach(*machine_, plan, share);
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, box.centre, moved);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        const BoxTask& task = tasks[i];
        Question& q = questions_[i];
        q = Question{};
        q.mesh_a = task.mesh_a;
        q.mesh_b = task.mesh_b;
        q.r_mm = std::min(needed_mm(*machine_, task, moved, box), kMarginMmMax);
        q.pose_error_mm = kPlacementErrorMm;
        q.pose = relative_pose(compose(moved[task.body_a], task.at_a),
                               compose(moved[task.body_b], task.at_b));
        answers_[i] = Answer{};
    }
    engine(questions_.first(tasks.size()), answers_.first(tasks.size()));
    questions_count_ += static_cast<std::uint32_t>(tasks.size());
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < tasks.size(); ++i) {
        const bool is_far = answers_[i].status == AnswerStatus::ok &&
                            answers_[i].proof == Proof::far && questions_[i].r_mm < kMarginMmMax;
        if (!is_far) {
            questions_[open] = questions_[i];
            open_[open++] = {i, 0};
        }
    }
    return open;
}

void SpeedHint::ask_clearances(const Engine& engine, std::uint32_t open) noexcept {
    for (std::uint32_t i = 0; i < open; ++i) {
        questions_[i].ask = Ask::clearance;
        answers_[i] = Answer{};
    }
    engine(questions_.first(open), answers_.first(open));
    questions_count_ += open;
    for (std::uint32_t i = 0; i < open; ++i) {
        open_[i].clearance_mm =
            answers_[i].status == AnswerStatus::ok ? answers_[i].clearance_mm : 0;
    }
}

void SpeedHint::advise(const Engine& engine, const StopPlan& plan) noexcept {
    questions_count_ = 0;
    // A distance is cheap to find where little of it is of interest: a cap rises step by step.
    const std::uint32_t most = std::min(kSpeedCapRapid, 2U * cap_ + kCapStep);
    cap_ = 0;
    const StopCycle cycle = plan.cycle();
    const std::size_t needed = 2 * plan.tasks().size();
    AXG_ASSERT(plan.tasks().size() <= questions_.size());
    if (cycle.status != PlanStatus::ok || !cycle.is_settled ||
        plan.work().questions + needed > machine_->guard.questions) {
        return;
    }
    const std::uint32_t open = ask_far(engine, plan, static_cast<double>(most) / kSpeedCapRapid);
    if (open == 0) {
        cap_ = static_cast<std::uint8_t>(most);
        return;
    }
    ask_clearances(engine, open);
    const AxisRanges ranges = ranges_of(*machine_, plan);
    std::array<Pose, kBodiesMax> moved;
    move_bodies(*machine_, plan.picture().position, moved);
    cap_ = speed_cap([&](std::uint8_t feed) {
        const JointBox box = capped_box(*machine_, plan.picture(), ranges,
                                        static_cast<double>(feed) / kSpeedCapRapid);
        return feed <= most &&
               std::all_of(open_.begin(), open_.begin() + open, [&](const OpenPair& pair) {
                   return needed_mm(*machine_, plan.tasks()[pair.task], moved, box) <
                          pair.clearance_mm;
               });
    });
}

}  // namespace axg
