// SPDX-License-Identifier: Apache-2.0
// Bounds how far one axis can still move: free motion until the latest start of braking, then
// braking at the guaranteed deceleration or harder. Pure closed forms, rounded outwards; mm and s,
// or rad and s. Source: docs/theory/certificate.md, "How far an axis can go".
#pragma once

#include <limits>

namespace axg {

/// The promised limits of an axis. All positive.
struct AxisLimits {
    double speed_max = 0;
    double acceleration_max = 0;  // in free motion, either way
    double jerk_max = 0;          // of the change from acceleration to braking, and in free motion
                                  // from a bounded acceleration
    double stopping_min = 0;      // least deceleration that a stop reaches
    bool stop_turns_round = false;  // a stop that begins with an acceleration against the motion
                                    // obeys jerk_max, even if that reverses the axis
};

/// Possible motion of an axis at one instant. Accelerations beyond acceleration_max mean that they
/// are unbounded: they may jump.
struct AxisRange {
    double low = 0, high = 0;              // position
    double speed_low = 0, speed_high = 0;  // signed
    double acceleration_low = -std::numeric_limits<double>::infinity();
    double acceleration_high = std::numeric_limits<double>::infinity();
};

/// Every position from that instant to standstill.
struct ReachRange {
    double low = 0, high = 0;
};

/// @param free_s  latest start of braking after the instant of `now`; it may start earlier
/// Clips speeds to +-speed_max: a board that breaks that promise is a separate fault.
[[nodiscard]] ReachRange stop_reach(const AxisLimits& limits, const AxisRange& now,
                                    double free_s) noexcept;

/// Largest distance covered in the positive direction by an axis whose speed is within the range.
/// Never negative; never less for a wider range.
/// @param acceleration_high  upper bound at the start; acceleration_max or more: it may jump
[[nodiscard]] double forward_reach(
    const AxisLimits& limits, double speed_low, double speed_high, double free_s,
    double acceleration_high = std::numeric_limits<double>::infinity()) noexcept;

}  // namespace axg
