// SPDX-License-Identifier: Apache-2.0
#include "core/reach/stop_limits.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

namespace {

constexpr double kUp = 1.0 + 0x1p-40;  // exceeds the roundings of any formula below

/// Largest error of the time between two latches.
double latch_jitter_seconds(const Machine& machine) noexcept {
    const double stated_s = machine.guard.latch_jitter_s;
    const std::uint32_t jitter_us = arrival_jitter_us_of(machine.can);
    if (jitter_us == 0) {
        return stated_s;
    }
    // An instant by arrival has the error of that jitter, and the anchor that numbers arrivals may
    // be off by the share of a period.
    const double period_s = machine.can.sample_us * 1e-6;
    return std::max(stated_s, jitter_us * 1e-6 + period_s * kPeriodShare);
}

}  // namespace

AxisLimits stop_limits(const Machine& machine, std::uint32_t axis) noexcept {
    const Axis& of = machine.axes[axis];
    return {.speed_max = of.speed_max,
            .acceleration_max = of.acceleration_max,
            .jerk_max = of.jerk_max,
            .stopping_min = of.stopping_min,
            .stop_turns_round = machine.guard.stop_reversal == StopReversal::jerk_limited};
}

double capped_speed(const Axis& axis, double share) noexcept {
    // Bound of relative speed over a half-line of time: motion within +-f of its command, both with
    // accelerations up to a.
    const double swing = 2 * std::sqrt(2 * axis.acceleration_max * axis.following_error);
    return std::min(axis.speed_max, (share * axis.speed_max + swing) * kUp);
}

AgeSeconds age_seconds(const Machine& machine) noexcept {
    // A register with the value of the previous SYNC is one period of the board old.
    constexpr double kLongest = 1e-6 * (1 + kPeriodShare);
    const ValueAge age = machine.can.latched_age;
    return {.most = age.most_us * kLongest, .spread = (age.most_us - age.least_us) * kLongest};
}

double free_seconds(const Machine& machine, std::uint32_t samples) noexcept {
    const double period_s = machine.can.sample_us * 1e-6;
    return samples * period_s * (1 + kPeriodShare) + latch_jitter_seconds(machine) +
           machine.guard.board_reaction_s + age_seconds(machine).most;
}

SampleErrors sample_errors(const Machine& machine, std::uint32_t axis, double count) noexcept {
    const Axis& of = machine.axes[axis];
    return {.period_s = machine.can.sample_us * 1e-6,
            .period_share = kPeriodShare,
            .latch_jitter_s = latch_jitter_seconds(machine) + age_seconds(machine).spread,
            .position = of.position_error + of.following_error + count,
            .is_jerk_limited = machine.guard.free_jerk_limited};
}

void put_reach(const ReachRange& range, std::uint32_t axis, JointBox& box) noexcept {
    const double centre = 0.5 * (range.low + range.high);
    box.centre[axis] = centre;
    box.half[axis] = std::max(range.high - centre, centre - range.low) * kUp;
}

ReachRange axis_reach(const Machine& machine, std::uint32_t axis, const AxisLimits& limits,
                      const AxisRange& now, double free_s, double position_error) noexcept {
    const Axis& of = machine.axes[axis];
    ReachRange range = stop_reach(limits, now, free_s);
    if (machine.guard.travel_enforced && !of.unlimited) {
        range.low = std::max(range.low, std::min(of.min - position_error, now.low));
        range.high = std::min(range.high, std::max(of.max + position_error, now.high));
    }
    return range;
}

}  // namespace axg
