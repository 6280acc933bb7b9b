// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/motion/motion_limits.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

// With longer smoothing one axis of low jerk would slow every stop of the machine. Instead the
// planner lowers the acceleration of that axis.
constexpr double kSmoothSMin = 1e-3, kSmoothSMax = 0.2;

}  // namespace

MotionLimits make_motion_limits(const Machine& machine) {
    MotionLimits limits;
    limits.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    limits.cap_mm_s = machine.program_speed_mm_s;
    double smooth_s = kSmoothSMin;
    for (const Axis& axis : machine.axes) {
        smooth_s = std::max(smooth_s, 2.0 * axis.acceleration_max / axis.jerk_max);
    }
    smooth_s = std::min(smooth_s, kSmoothSMax);
    limits.smooth_steps = static_cast<std::uint32_t>(std::ceil(smooth_s / kMotionStepS - 1e-9));
    limits.smooth_s = limits.smooth_steps * kMotionStepS;
    for (std::uint32_t i = 0; i < limits.axis_count; ++i) {
        const Axis& axis = machine.axes[i];
        limits.speed[i] = axis.speed_max;
        limits.acceleration[i] = axis.acceleration_max;
        limits.jerk[i] = axis.jerk_max;
        limits.planned_acceleration[i] =
            std::min(axis.acceleration_max, axis.jerk_max * limits.smooth_s / 2.0);
        const bool is_uvw = axis.name == "U" || axis.name == "V" || axis.name == "W";
        limits.feed_group[i] = axis.kind == AxisKind::rotary ? 2 : (is_uvw ? 1 : 0);
        limits.metric[i] = axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0;
    }
    return limits;
}

void LimitMeter::add(const AxisPositions& position) noexcept {
    for (std::uint32_t i = 0; i < axis_count_; ++i) {
        const double step = position[i] - last_[i];
        const double bend = step - step_[i];
        const double twist = bend - bend_[i];
        if (seen_ >= 1) {
            peaks_[i].speed = std::max(peaks_[i].speed, std::abs(step) / kMotionStepS);
        }
        if (seen_ >= 2) {
            peaks_[i].acceleration =
                std::max(peaks_[i].acceleration, std::abs(bend) / (kMotionStepS * kMotionStepS));
        }
        if (seen_ >= 3) {
            peaks_[i].jerk = std::max(
                peaks_[i].jerk, std::abs(twist) / (kMotionStepS * kMotionStepS * kMotionStepS));
        }
        last_[i] = position[i];
        step_[i] = step;
        bend_[i] = bend;
    }
    seen_ = std::min(seen_ + 1, 3U);
}

}  // namespace axg
