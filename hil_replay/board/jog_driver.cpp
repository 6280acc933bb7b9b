// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/jog_driver.hpp"

#include <algorithm>

namespace axg {

namespace {

struct Limits {
    double speed, acceleration;
};

/// Repeats the guard's jog_limits(): a board shares no motion code with the guard.
Limits limits_of(const Machine& machine, std::uint32_t axis) {
    const Axis& a = machine.axes[axis];
    const JogRules& jog = machine.guard.jog;
    const bool is_rotary = a.kind == AxisKind::rotary;
    return {
        std::min(a.speed_max, is_rotary ? jog.speed_rad_s : jog.speed_mm_s),
        std::min(a.acceleration_max, is_rotary ? jog.acceleration_rad_s2 : jog.acceleration_mm_s2)};
}

}  // namespace

CommandedMotion make_jog(const Machine& machine, const JogMotionPlan& plan) {
    return [&machine, plan, speed = 0.0, gone = 0.0](std::span<AxisMotion> axes) mutable {
        const Limits limits = limits_of(machine, plan.move.axis);
        const double gain = limits.acceleration * plan.tick_s;
        // Distance of this tick, should it accelerate, and of slowing down after it.
        const double faster = std::min(limits.speed, speed + gain);
        const double needed = 0.5 * (speed + faster) * plan.tick_s +
                              0.5 * faster * (faster / limits.acceleration + plan.tick_s);
        const double next = gone + needed <= plan.distance ? faster : std::max(0.0, speed - gain);
        const bool is_over = speed == 0 && next == 0;
        AxisMotion& axis = axes[plan.move.axis];
        const double sign = plan.move.is_negative ? -1 : 1;
        axis.speed = sign * speed;
        axis.acceleration = sign * (next - speed) / plan.tick_s;
        axis.jerk = 0;
        gone += 0.5 * (speed + next) * plan.tick_s;
        speed = next;
        return MotionTick{.is_over = is_over,
                          .tool = plan.tool == 0 ? machine.first_tool : plan.tool};
    };
}

}  // namespace axg
