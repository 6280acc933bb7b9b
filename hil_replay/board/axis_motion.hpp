// SPDX-License-Identifier: Apache-2.0
// One simulated axis as it truly moves: pieces of constant jerk, and a stop of its own. Closed
// forms, so that no step size decides where an axis comes to rest. mm and s, or rad and s.
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

/// Where the axis is `seconds` later, at its jerk.
[[nodiscard]] AxisMotion moved_on(const AxisMotion& axis, double seconds) noexcept;

/// A stop of one axis: the acceleration falls at `jerk` to -deceleration, along the motion, and
/// stays there to standstill. The axis never turns round.
struct Brake {
    double deceleration = 0, jerk = 0;
    int way = 0;  // 1, -1: what it brakes from; the axis still moves the other way when the stop
                  // begins, and its acceleration turns it round. 0: the way that it moves
};

/// Brakes for `seconds`; an axis that rests keeps its place.
void brake(AxisMotion& axis, const Brake& how, double seconds) noexcept;

[[nodiscard]] constexpr bool is_resting(const AxisMotion& axis) noexcept {
    return axis.speed == 0 && axis.acceleration == 0;
}

}  // namespace axg
