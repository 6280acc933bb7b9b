// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/c_interface/board_terms.hpp"

#include <algorithm>
#include <cmath>

#include "core/reach/jog.hpp"
#include "core/reach/stop_limits.hpp"
#include "firmware_if/c_interface/sample_frames.hpp"

namespace axg {
namespace {

constexpr double kDegPerRad = 0x1.ca5dc1a63c1f8p+5;
constexpr double kUsPerS = 1e6;
constexpr double kRoundingUs = 1e-3;  // more than those of seconds, and less than matters

std::uint32_t microseconds(double seconds) noexcept {
    return static_cast<std::uint32_t>(std::lround(seconds * kUsPerS));
}

/// No less: an age of 1 % more is no whole number of microseconds.
std::uint32_t microseconds_up(double seconds) noexcept {
    return static_cast<std::uint32_t>(std::ceil(seconds * kUsPerS - kRoundingUs));
}

/// A tolerance that a board compares is none beyond the proven one.
float rounded_down(double value) noexcept {
    const auto nearest = static_cast<float>(value);
    return nearest > value ? std::nextafter(nearest, 0.0F) : nearest;
}

axg_axis axis_of(const Axis& axis, const JogRules& jogs) noexcept {
    axg_axis out{};
    axis.name.copy(out.name, sizeof out.name - 1);
    out.is_rotary = axis.kind == AxisKind::rotary ? 1 : 0;
    out.is_endless = axis.unlimited ? 1 : 0;
    const double unit = out.is_rotary != 0 ? kDegPerRad : 1.0;
    out.min = axis.min * unit;
    out.max = axis.max * unit;
    out.speed = axis.speed_max * unit;
    out.acceleration = axis.acceleration_max * unit;
    out.jerk = has_jerk_limit(axis) ? axis.jerk_max * unit : 0;
    out.stopping = axis.stopping_min * unit;
    out.skew_mm = rounded_down(axis.skew_mm);
    if (jogs.is_promised) {
        const AxisLimits limits = jog_limits(jogs, axis);
        out.jog_speed = limits.speed_max * unit;
        out.jog_acceleration = limits.acceleration_max * unit;
    }
    return out;
}

}  // namespace

axg_terms board_terms(const Machine& machine, const ConfigurationHashes& hashes) noexcept {
    const CanLayout& can = machine.can;
    axg_terms out{};
    out.period_us = can.sample_us;
    // A board needs only the sum, for H(n).
    out.jitter_us =
        microseconds(machine.guard.latch_jitter_s) + microseconds_up(age_seconds(machine).most);
    out.reaction_us = microseconds(machine.guard.board_reaction_s);
    out.permit_id = can.permit_id;
    out.stop_id = can.stop_id;
    out.hashes_in_id = can.hashes_in_id;
    out.hashes_out_id = can.hashes_out_id;
    out.operator_in_id = can.operator_in_id;
    out.operator_out_id = can.operator_out_id;
    std::copy(hashes.of.begin(), hashes.of.end(), out.hashes);
    out.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    out.first_tool = machine.first_tool;
    out.permit_version = has_sample_counter(can) ? 2 : 0;
    out.permit_samples_max = can.permit_samples.most;
    out.takes_samples = takes_samples(machine) ? 1 : 0;
    out.is_independent = machine.guard.promise == StopPromise::independent ? 1 : 0;
    std::transform(machine.axes.begin(), machine.axes.end(), out.axes,
                   [&](const Axis& axis) { return axis_of(axis, machine.guard.jog); });
    return out;
}

}  // namespace axg
