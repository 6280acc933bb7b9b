// SPDX-License-Identifier: Apache-2.0
// What a machine file promises of the motion of its axes, as the certificate uses it: limits,
// errors of the samples, and the time until braking. Pure. Source: docs/theory/certificate.md,
// "How far an axis can go".
#pragma once

#include <cstdint>

#include "core/certificate/joint_path.hpp"
#include "core/certificate/motion_history.hpp"
#include "core/certificate/stop_reach.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// How old positions are at their latch, s, in the longest periods of the board.
struct AgeSeconds {
    double most = 0;
    double spread = 0;  // by which one may be older than another
};
[[nodiscard]] AgeSeconds age_seconds(const Machine& machine) noexcept;

/// From the instant of a sample's positions until the board must have begun to brake, s: they had
/// an age at the latch, the permit for them, valid for so many samples, has run out, and the board
/// has reacted.
[[nodiscard]] double free_seconds(const Machine& machine, std::uint32_t samples) noexcept;

/// Errors of the positions that a board's frames report.
/// @param count  mm or rad of one count on the wire
[[nodiscard]] SampleErrors sample_errors(const Machine& machine, std::uint32_t axis,
                                         double count) noexcept;

[[nodiscard]] AxisLimits stop_limits(const Machine& machine, std::uint32_t axis) noexcept;

/// How fast an axis gets at most whose commands its board keeps below this share of its largest
/// speed: it swings about them within its following error, and a stop may begin at any point of
/// that.
[[nodiscard]] double capped_speed(const Axis& axis, double share) noexcept;

/// Where `axis` can get until it stands, mm or rad. A travel that the board enforces ends it.
/// @param free_s          free_seconds of the permit
/// @param position_error  of reported positions, by which the travel is wider
[[nodiscard]] ReachRange axis_reach(const Machine& machine, std::uint32_t axis,
                                    const AxisLimits& limits, const AxisRange& now, double free_s,
                                    double position_error) noexcept;
/// The axis of a box that lies around the range, roundings included.
void put_reach(const ReachRange& range, std::uint32_t axis, JointBox& box) noexcept;

}  // namespace axg
