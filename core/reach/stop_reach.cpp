// SPDX-License-Identifier: Apache-2.0
#include "core/reach/stop_reach.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

namespace {

constexpr double kUp = 1.0 + 0x1p-40;  // exceeds the roundings of any formula below

/// Distance gained while the speed rises from `from` at `slope`: only forward motion counts.
double forward_part(double from, double slope, double time) noexcept {
    const double to = from + slope * time;
    if (from >= 0) {
        return 0.5 * (from + to) * time;
    }
    return to > 0 ? 0.5 * to * to / slope : 0;
}

struct FreeMotion {
    double distance, speed, acceleration;
};

/// Full acceleration forwards, capped at the largest speed.
FreeMotion accelerate(const AxisLimits& l, double speed, double time) noexcept {
    const double until_cap = std::min(time, (l.speed_max - speed) / l.acceleration_max);
    const double capped = speed + l.acceleration_max * until_cap;
    return {forward_part(speed, l.acceleration_max, until_cap) +
                std::max(capped, 0.0) * (time - until_cap),
            capped, l.acceleration_max};
}

/// The acceleration rises by the jerk until it is full, or time is up.
FreeMotion move_freely(const AxisLimits& l, double speed, double acceleration,
                       double time) noexcept {
    const double rise = std::min(time, (l.acceleration_max - acceleration) / l.jerk_max);
    const double risen = speed + rise * (acceleration + 0.5 * l.jerk_max * rise);
    // While the acceleration rises, the speed is below its chord, and below full acceleration.
    const double chord = 0.5 * (std::max(speed, 0.0) + std::max(risen, 0.0)) * rise;
    const double exact = rise * (speed + rise * (0.5 * acceleration + rise * l.jerk_max / 6));
    const bool is_forward = speed >= 0 && acceleration >= 0;
    const double distance =
        std::min(is_forward ? exact : chord, accelerate(l, speed, rise).distance);
    const FreeMotion full = accelerate(l, std::min(risen, l.speed_max), time - rise);
    return {distance + full.distance, full.speed, acceleration + l.jerk_max * rise};
}

/// Braking from an acceleration a >= -stopping_min: the jerk lowers it to -stopping_min, where it
/// remains.
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

/// The same for a speed that never exceeds speed_max: an acceleration a0 at the start of braking
/// adds a0^2 / 2j to the speed there, which is at least `least`. So the speed is at its largest for
/// at most a0 / j, then falls.
double capped_braking_distance(const AxisLimits& l, double least, double a) noexcept {
    const double room = std::max(0.0, l.speed_max - least);
    const double start = std::clamp(a, 0.0, std::sqrt(2 * l.jerk_max * room));
    return l.speed_max * start / l.jerk_max + braking_distance(l, l.speed_max, 0);
}

/// For an axis that moves back with a forward acceleration b, which the jerk lowers: the remainder
/// of b when the axis reverses, sqrt(b^2 - 2 j |v|); 0: it does not reverse.
double acceleration_at_turn(const AxisLimits& l, const FreeMotion& back) noexcept {
    const double b = back.acceleration;
    const double square = b * b * kUp + 2 * l.jerk_max * back.speed;
    return b > 0 && square > 0 ? std::min(b, std::sqrt(square)) : 0;
}

/// For an axis that a stop reverses: before that, the jerk lowers its deceleration b to 0. From v,
/// v <= b^2 / 2J, the axis moves at most (2/3) v^2 / b farther, for any b and any jerk J >= j.
double distance_before_turn(const AxisLimits& l, double fastest) noexcept {
    if (!l.stop_turns_round) {
        return 0;
    }
    const double a = l.acceleration_max, j = l.jerk_max;
    const double v = std::clamp(fastest, 0.0, 0.5 * a * a / j);
    return v * std::sqrt(v / (2 * j)) * 2 / 3;
}

}  // namespace

double forward_reach(const AxisLimits& limits, double speed_low, double speed_high, double free_s,
                     double acceleration_high) noexcept {
    const double most = std::clamp(speed_high, -limits.speed_max, limits.speed_max);
    // A stop may end the free motion at any time, at stopping_min and not harder. Its acceleration
    // is not lower than that, so the free motion does not assume a lower one, either.
    const double floor = std::max(-limits.stopping_min, -limits.acceleration_max);
    const double acceleration = std::clamp(acceleration_high, floor, limits.acceleration_max);
    const FreeMotion free = move_freely(limits, most, acceleration, free_s);
    const double before_turn = distance_before_turn(limits, std::max(most, free.speed));
    double from_speed = free.speed, from_acceleration = free.acceleration;
    if (free.speed <= 0) {  // the axis moves back
        from_speed = 0;
        from_acceleration = limits.stop_turns_round ? acceleration_at_turn(limits, free) : 0;
    }
    if (from_speed <= 0 && !(from_acceleration > 0)) {
        return (free.distance + before_turn) * kUp;  // and braking does not reverse it
    }
    const double least =
        std::max(-limits.speed_max, std::min(speed_low, most) - limits.acceleration_max * free_s);
    const double braking = std::min(braking_distance(limits, from_speed, from_acceleration),
                                    capped_braking_distance(limits, least, free.acceleration));
    return (free.distance + std::max(braking, before_turn)) * kUp;
}

ReachRange stop_reach(const AxisLimits& limits, const AxisRange& now, double free_s) noexcept {
    return {now.low - forward_reach(limits, -now.speed_high, -now.speed_low, free_s,
                                    -now.acceleration_low),
            now.high + forward_reach(limits, now.speed_low, now.speed_high, free_s,
                                     now.acceleration_high)};
}

}  // namespace axg
