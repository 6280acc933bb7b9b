// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/axis_motion.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

AxisMotion moved_on(const AxisMotion& axis, double seconds) noexcept {
    const double t = seconds, j = axis.jerk;
    AxisMotion on = axis;
    on.position += t * (axis.speed + t * (0.5 * axis.acceleration + t * j / 6));
    on.speed += t * (axis.acceleration + t * 0.5 * j);
    on.acceleration += t * j;
    return on;
}

void brake(AxisMotion& axis, const Brake& how, double seconds) noexcept {
    const bool is_forward = axis.speed > 0 || (axis.speed == 0 && axis.acceleration > 0);
    const double direction = how.way != 0 ? how.way : is_forward ? 1 : -1;
    double v = direction * axis.speed, a = direction * axis.acceleration, gained = 0;
    if (v < 0) {  // until it turns round
        const double turn = (a - std::sqrt(std::max(0.0, a * a + 2 * how.jerk * v))) / how.jerk;
        const double t = std::min(seconds, turn);
        gained = t * (v + t * (0.5 * a - t * how.jerk / 6));
        v = t == turn ? 0 : std::min(0.0, v + t * (a - 0.5 * t * how.jerk));
        a -= t * how.jerk;
        axis.position += direction * gained;
        axis.speed = direction * v;
        axis.acceleration = direction * a;
        gained = 0;
        seconds -= t;
        if (v < 0) {
            axis.jerk = 0;
            return;
        }
    }
    if (a > -how.deceleration && (v > 0 || a > 0)) {
        const double ramp = (a + how.deceleration) / how.jerk;
        const double standstill = (a + std::sqrt(a * a + 2 * how.jerk * v)) / how.jerk;
        const double t = std::min({seconds, ramp, standstill});
        gained = t * (v + t * (0.5 * a - t * how.jerk / 6));
        v = t == standstill ? 0 : std::max(0.0, v + t * (a - 0.5 * t * how.jerk));
        a = t == ramp ? -how.deceleration : a - t * how.jerk;
        seconds -= t;
    }
    if (seconds > 0 && v > 0) {
        const double t = std::min(seconds, v / how.deceleration);
        gained += t * (v - 0.5 * t * how.deceleration);
        v = t < seconds ? 0 : std::max(0.0, v - t * how.deceleration);
        a = -how.deceleration;
    }
    axis.position += direction * gained;
    axis.speed = direction * v;
    axis.acceleration = v > 0 || a > 0 ? direction * a : 0;
    axis.jerk = 0;
    if (is_resting(axis)) {
        axis.speed = axis.acceleration = 0;  // and no negative zeros
    }
}

}  // namespace axg
