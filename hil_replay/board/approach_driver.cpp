// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/approach_driver.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

namespace {

/// Speed from which an axis can still stop within `distance`: v^2/2a + va/2j = distance. With half
/// of its acceleration: the other half is for following this curve with a bounded jerk.
double speed_for(const Axis& axis, double distance) noexcept {
    const double a = 0.5 * axis.acceleration_max,
                 ramp = 0.5 * axis.acceleration_max / axis.jerk_max;
    return a * (std::sqrt(ramp * ramp + 2 * distance / a) - ramp);
}

/// Speed bound of an axis in each direction.
struct Kept {
    double down = 0, up = 0;

    [[nodiscard]] bool holds(double speed) const noexcept {
        constexpr double kRounding = 1 + 1e-12;  // a motion may run along its limits
        return speed <= up * kRounding && -speed <= down * kRounding;
    }
};

/// Bounds for `share_kept`. An axis that is faster may not speed up further in its direction; in
/// the other direction the share applies.
Kept kept_by(const Axis& axis, const AxisMotion& now, double share_kept) noexcept {
    const double end =
        now.speed + 0.5 * now.acceleration * std::abs(now.acceleration) / axis.jerk_max;
    const double most = axis.speed_max, least = share_kept * most;
    return {.down = std::min(most, std::max({least, -now.speed, -end})),
            .up = std::min(most, std::max({least, now.speed, end}))};
}

/// Whether this jerk is allowed for a tick: the limits hold at its end, even while the acceleration
/// returns to zero, and the speed bound holds where the acceleration crosses zero in the tick.
bool is_legal(const Axis& axis, const Kept& kept, const AxisMotion& now, double jerk,
              double tick_s) noexcept {
    constexpr double kRounding = 1 + 1e-12;
    AxisMotion trial = now;
    trial.jerk = jerk;
    const AxisMotion then = moved_on(trial, tick_s);
    const double swing = 0.5 * then.acceleration * std::abs(then.acceleration) / axis.jerk_max;
    if (std::abs(then.acceleration) > axis.acceleration_max * kRounding ||
        !kept.holds(then.speed + swing) || !kept.holds(then.speed)) {
        return false;
    }
    if (now.acceleration * then.acceleration >= 0) {
        return true;
    }
    return kept.holds(now.speed - 0.5 * now.acceleration * now.acceleration / jerk);
}

/// Whether a few ticks of jerk could end the remaining motion.
bool nearly_stands(const Axis& axis, const AxisMotion& now, double tick_s) noexcept {
    const double step = axis.jerk_max * tick_s;
    return std::abs(now.acceleration) <= 2 * step && std::abs(now.speed) <= 2 * step * tick_s;
}

/// Whether they could also cover the remaining distance: the axis then stops here.
bool has_arrived(const Axis& axis, const AxisMotion& now, double target, double tick_s) noexcept {
    const double step = axis.jerk_max * tick_s;
    return nearly_stands(axis, now, tick_s) &&
           std::abs(target - now.position) <= 10 * step * tick_s * tick_s;
}

}  // namespace

double approach_jerk(const Axis& axis, const AxisMotion& now, double target, double speed_share,
                     double tick_s, double share_kept) noexcept {
    const double j = axis.jerk_max;
    const Kept kept = kept_by(axis, now, share_kept);
    // Position and speed once the axis no longer accelerates towards the target.
    AxisMotion level = now;
    if (now.acceleration * (target - now.position) > 0) {
        level.jerk = std::copysign(j, -now.acceleration);
        level = moved_on(level, std::abs(now.acceleration) / j);
    }
    const double error = target - level.position;
    const double fastest = std::min(speed_share * axis.speed_max, speed_for(axis, std::abs(error)));
    const double missing = std::copysign(fastest, error) - level.speed;
    const double acceleration = std::copysign(
        std::min(axis.acceleration_max, std::sqrt(2 * j * std::abs(missing))), missing);
    const double jerk = std::clamp((acceleration - now.acceleration) / tick_s, -j, j);
    const double none = std::clamp(-now.acceleration / tick_s, -j, j);
    for (const double allowed : {jerk, none}) {
        if (is_legal(axis, kept, now, allowed, tick_s)) {
            return allowed;
        }
    }
    return now.acceleration > 0 ? -j : j;  // legal again if the axis was legal before
}

CommandedMotion make_approach(const Machine& machine, const Approach& approach, const double* share,
                              AxisShares* axis_shares) {
    return [&machine, approach, share, axis_shares](std::span<AxisMotion> axes) {
        const double most_of_all = share != nullptr ? *share : 1;
        for (std::size_t i = 0; i < axes.size(); ++i) {
            const double most = axis_shares != nullptr ? axis_shares->wanted[i] : most_of_all;
            if (axis_shares != nullptr) {
                axis_shares->needed[i] = std::max(axis_shares->needed[i], most);
            }
            const bool is_held =
                most <= 0 && nearly_stands(machine.axes[i], axes[i], approach.tick_s);
            if (is_held ||
                has_arrived(machine.axes[i], axes[i], approach.target[i], approach.tick_s)) {
                axes[i] = {.position = axes[i].position};
                continue;
            }
            axes[i].jerk =
                approach_jerk(machine.axes[i], axes[i], approach.target[i],
                              std::min(most, approach.speed_share[i]), approach.tick_s, most);
        }
        return MotionTick{.is_over = false, .tool = machine.first_tool};
    };
}

}  // namespace axg
