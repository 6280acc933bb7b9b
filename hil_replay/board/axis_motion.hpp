// SPDX-License-Identifier: Apache-2.0
// True motion of one simulated axis: pieces of constant jerk, and its own stop. Closed forms, so
// that the rest position does not depend on a step size. mm and s, or rad and s.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/limits.hpp"

namespace axg {

struct AxisMotion {
    double position = 0, speed = 0, acceleration = 0;
    double jerk = 0;  // until the next tick
};
using AxisMotions = std::array<AxisMotion, kAxesMax>;

/// Returns the state of the axis `seconds` later, at its jerk.
[[nodiscard]] AxisMotion moved_on(const AxisMotion& axis, double seconds) noexcept;

/// A stop of one axis: the acceleration falls at `jerk` to -deceleration, along the motion, and
/// stays there to standstill. The axis reverses only if `way` is set.
struct Brake {
    double deceleration = 0, jerk = 0;
    int way = 0;  // 1, -1: direction to brake from, although the axis moves the other way when the
                  // stop begins: its acceleration reverses it. 0: the direction of its motion
};

/// Brakes for `seconds`; an axis at rest does not move.
void brake(AxisMotion& axis, const Brake& how, double seconds) noexcept;

[[nodiscard]] constexpr bool is_resting(const AxisMotion& axis) noexcept {
    return axis.speed == 0 && axis.acceleration == 0;
}

}  // namespace axg
