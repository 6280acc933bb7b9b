// SPDX-License-Identifier: Apache-2.0
// The promises of a machine file about axis motion, in the form that the certificate needs: limits,
// errors of the samples, and the time until braking. Pure. Source: docs/theory/certificate.md,
// "How far an axis can go".
#pragma once

#include <cstdint>

#include "core/machine/machine.hpp"
#include "core/reach/joint_box.hpp"
#include "core/reach/motion_history.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {

/// Age of positions at their latch, s, with the longest period of the board.
struct AgeSeconds {
    double most = 0;
    double spread = 0;  // largest difference of two ages
};
[[nodiscard]] AgeSeconds age_seconds(const Machine& machine) noexcept;

/// Time from the instant of a sample's positions to the latest start of braking, s: their age at
/// the latch with its jitter, the validity of their permit (`samples` periods), and the reaction of
/// the board.
[[nodiscard]] double free_seconds(const Machine& machine, std::uint32_t samples) noexcept;

/// Errors of the positions that a board's frames report.
/// @param count  mm or rad of one count on the wire
[[nodiscard]] SampleErrors sample_errors(const Machine& machine, std::uint32_t axis,
                                         double count) noexcept;

[[nodiscard]] AxisLimits stop_limits(const Machine& machine, std::uint32_t axis) noexcept;

/// Largest speed of an axis whose board limits its commands to this share of its largest speed: the
/// axis swings about its commands within its following error, and a stop may begin at any point of
/// the swing.
[[nodiscard]] double capped_speed(const Axis& axis, double share) noexcept;

/// Reach of `axis`: every position until it rests, mm or rad; bounded by an enforced travel.
/// @param free_s          free_seconds of the permit
/// @param position_error  of reported positions; widens the travel
[[nodiscard]] ReachRange axis_reach(const Machine& machine, std::uint32_t axis,
                                    const AxisLimits& limits, const AxisRange& now, double free_s,
                                    double position_error) noexcept;
/// Sets the axis of a box to enclose the range, roundings included.
void put_reach(const ReachRange& range, std::uint32_t axis, JointBox& box) noexcept;

}  // namespace axg
