// SPDX-License-Identifier: Apache-2.0
// Limits of the axes for the planner, and a meter that checks the planned motion.
#pragma once

#include <array>
#include <cstdint>

#include "hil_replay/motion/program.hpp"

namespace axg {

inline constexpr double kMotionStepS = 1e-4;  // interpolation, 0.1 ms
inline constexpr std::uint32_t kMotionStepUs = 100;

/// Limits with one smoothing time for all axes. The path's speed is planned with bounded
/// acceleration and then averaged over smooth_s; an acceleration within +-A becomes a jerk within 2
/// A / smooth_s, so acceleration[i] is chosen such that both of axis i's limits hold.
struct MotionLimits {
    std::uint32_t axis_count = 0;
    std::uint32_t smooth_steps = 1;  // of kMotionStepS
    double smooth_s = kMotionStepS;
    std::array<double, kAxesMax> speed{}, acceleration{},
        jerk{};                                           // of the axis, as in the machine file
    std::array<double, kAxesMax> planned_acceleration{};  // min(acceleration, jerk smooth_s / 2)
    std::array<double, kAxesMax>
        metric{};  // path mm a unit: 1 for mm, 180/pi for rad (one degree counts one mm)
    std::array<std::uint8_t, kAxesMax>
        feed_group{};     // 0: X Y Z, 1: U V W, 2: rotary; F counts along one group
    double cap_mm_s = 0;  // of the path of X Y Z
};
[[nodiscard]] MotionLimits make_motion_limits(const Machine& machine);

/// Largest first, second and third differences of positions on the 0.1 ms grid, divided by powers
/// of the step: the actual speed, acceleration and jerk of the trace.
class LimitMeter {
  public:
    explicit LimitMeter(std::uint32_t axis_count) : axis_count_(axis_count) {}
    void add(const AxisPositions& position) noexcept;

    struct Peak {
        double speed = 0, acceleration = 0, jerk = 0;
    };
    [[nodiscard]] const Peak& peak(std::uint32_t axis) const { return peaks_[axis]; }

  private:
    std::uint32_t axis_count_;
    std::uint32_t seen_ = 0;  // up to 3
    AxisPositions last_{}, step_{}, bend_{};
    std::array<Peak, kAxesMax> peaks_{};
};

}  // namespace axg
