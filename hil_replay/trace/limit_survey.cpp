// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/limit_survey.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kWindowStrides = 3 * kLimitStrides.back();
constexpr double kAbove = 1.1, kBelow = 0.9;

void note_peak(LimitPeak& peak, double measured, double declared, std::int64_t time_us) noexcept {
    if (measured > peak.measured) {
        peak.measured = measured;
        peak.time_us = time_us;
    }
    peak.samples_above += measured > declared ? 1 : 0;
}

/// To two digits: up, or down.
double rounded(double value, bool is_up) noexcept {
    if (!(value > 0)) {
        return 0;
    }
    const double digit = std::pow(10, std::floor(std::log10(value)) - 1);
    const double digits = value / digit;
    return (is_up ? std::ceil(digits - 1e-9) : std::floor(digits + 1e-9)) * digit;
}

}  // namespace

LimitSurvey::LimitSurvey(const Machine& machine)
    : rules_(limit_rules(machine, axis_units(machine))), axes_(machine.axes.size()) {}

void LimitSurvey::add(const AxisSnapshot& snapshot, bool is_first) noexcept {
    if (is_first) {
        history_.count = 0;
        forget_limits(watch_);
    }
    note_snapshot(history_, snapshot, rules_.stride);
    const LimitFact fact = note_limits(watch_, rules_, snapshot, history_);
    if (snapshot.sample % rules_.stride != 0) {
        return;
    }
    for (std::uint32_t i = 0; i < rules_.axis_count; ++i) {
        add_axis(i, snapshot);
    }
    if (fact.kind == LimitKind::acceleration) {  // of a stop that was none: no axis shows it now
        note_peak(axes_[fact.axis].acceleration, fact.measured, fact.declared, snapshot.arrived_us);
    }
}

void LimitSurvey::add_axis(std::uint32_t axis, const AxisSnapshot& snapshot) noexcept {
    AxisLimitSurvey& seen = axes_[axis];
    const AxisLimits& declared = rules_.axes[axis].limits;
    const LimitFigures figures = measure_limits(watch_, rules_, axis);
    const bool is_stopping = watch_.stops[axis].is_on;
    if (is_stopping) {
        seen.hardest_in_stop = std::max(seen.hardest_in_stop, figures.acceleration);
    } else if (seen.hardest_in_stop > 0) {
        seen.softest_stop = ++seen.stops == 1 ? seen.hardest_in_stop
                                              : std::min(seen.softest_stop, seen.hardest_in_stop);
        seen.hardest_in_stop = 0;
    }
    seen.seen_speed = std::max(seen.seen_speed, figures.seen_speed);
    note_peak(seen.speed, figures.speed, declared.speed_max, snapshot.arrived_us);
    const std::uint64_t judged_from = watch_.judged_from[axis];
    const bool shows_stop =
        is_stopping || (judged_from > 0 && watch_.newest < judged_from + kWindowStrides);
    if (!shows_stop) {
        seen.seen_acceleration = std::max(seen.seen_acceleration, figures.seen_acceleration);
        note_peak(seen.acceleration, figures.acceleration, declared.acceleration_max,
                  snapshot.arrived_us);
        note_peak(seen.jerk, figures.jerk,
                  rules_.axes[axis].errors.is_jerk_limited ? declared.jerk_max : HUGE_VAL,
                  snapshot.arrived_us);
    }
}

ProposedLimits proposed_limits(const Axis& axis, const AxisLimitSurvey& seen,
                               double stride_s) noexcept {
    const bool is_rotary = axis.kind == AxisKind::rotary;
    const double unit = is_rotary ? 180.0 / kPi : 1.0;
    const double per_minute = is_rotary ? 1 : 60;
    ProposedLimits out;
    out.speed =
        rounded(kAbove * std::max(seen.speed.measured, seen.seen_speed) * unit * per_minute, true);
    out.acceleration =
        rounded(kAbove * std::max(seen.acceleration.measured, seen.seen_acceleration) * unit, true);
    out.jerk = rounded(kAbove * seen.jerk.measured * unit, true);
    out.stopping = rounded(kBelow * seen.softest_stop * unit, false);
    out.is_jerk_unlimited = seen.jerk.measured * stride_s >= seen.acceleration.measured &&
                            seen.acceleration.measured > 0;
    return out;
}

}  // namespace axg
