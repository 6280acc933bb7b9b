// SPDX-License-Identifier: Apache-2.0
#include "core/stop_reach.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

namespace {

constexpr double kUp = 1.0 + 0x1p-40;  // more than the roundings of any formula below

/// Distance gained while the speed rises from `from` at `slope`: only what goes forward counts.
double forward_part(double from, double slope, double time) noexcept {
    const double to = from + slope * time;
    if (from >= 0) {
        return 0.5 * (from + to) * time;
    }
    return to > 0 ? 0.5 * to * to / slope : 0;
}

struct FreeMotion {
    double distance, speed;
};

/// Full acceleration forwards, capped at the largest speed.
FreeMotion accelerate(const AxisLimits& l, double speed, double time) noexcept {
    const double until_cap = std::min(time, (l.speed_max - speed) / l.acceleration_max);
    const double capped = speed + l.acceleration_max * until_cap;
    return {forward_part(speed, l.acceleration_max, until_cap) +
                std::max(capped, 0.0) * (time - until_cap),
            capped};
}

/// Braking from an acceleration a >= 0: it falls by the jerk to -stopping_min and stays there.
double braking_distance(const AxisLimits& l, double speed, double a) noexcept {
    const double d = l.stopping_min, j = l.jerk_max;
    // speed + a t - j t^2 / 2 is zero, or the ramp is over, whichever comes first.
    const double ramp = (a + d) / j;
    const double standstill = (a + std::sqrt(a * a + 2 * j * speed)) / j;
    const double t = std::min(ramp, standstill);
    const double in_ramp = t * (speed + t * (0.5 * a - t * j / 6));
    const double after = std::max(0.0, speed + t * (a - 0.5 * j * t));
    return in_ramp + 0.5 * after * after / d;
}

/// The same, knowing that the speed never exceeds its largest: an acceleration a0 at the start of
/// braking adds a0^2 / 2j to the speed there, and that was at least `least`. So the speed is at its
/// largest no longer than a0 / j, and then falls.
double capped_braking_distance(const AxisLimits& l, double least) noexcept {
    const double room = std::max(0.0, l.speed_max - least);
    const double start = std::min(l.acceleration_max, std::sqrt(2 * l.jerk_max * room));
    return l.speed_max * start / l.jerk_max + braking_distance(l, l.speed_max, 0);
}

}  // namespace

double forward_reach(const AxisLimits& limits, double speed_low, double speed_high,
                     double free_s) noexcept {
    const double most = std::clamp(speed_high, -limits.speed_max, limits.speed_max);
    const FreeMotion free = accelerate(limits, most, free_s);
    if (free.speed <= 0) {
        return 0;  // it went back all the time, and braking does not turn it around
    }
    const double least =
        std::max(-limits.speed_max, std::min(speed_low, most) - limits.acceleration_max * free_s);
    const double braking = std::min(braking_distance(limits, free.speed, limits.acceleration_max),
                                    capped_braking_distance(limits, least));
    return (free.distance + braking) * kUp;
}

ReachRange stop_reach(const AxisLimits& limits, const AxisRange& now, double free_s) noexcept {
    return {now.low - forward_reach(limits, -now.speed_high, -now.speed_low, free_s),
            now.high + forward_reach(limits, now.speed_low, now.speed_high, free_s)};
}

}  // namespace axg
