// SPDX-License-Identifier: Apache-2.0
// Worst motion that a program can command: every axis moves to its target as fast as its limits
// allow, and rests there.
#pragma once

#include <cstdint>
#include <span>

#include "core/machine/machine.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {

struct Approach {
    std::array<double, kAxesMax> target{};
    std::array<double, kAxesMax> speed_share{};  // of each axis' largest speed, in (0, 1]
    double tick_s = 1e-3;
};

/// Speed, acceleration and jerk stay within the axis' limits at every instant, and the speed would
/// also if the acceleration had to return to zero from there. `machine` must outlive the motion.
/// @param share  bound of each axis' speed, read at every tick, as a share of its largest; null: 1
/// @param axis_shares  bound for each axis, in place of `share`; null: none
[[nodiscard]] CommandedMotion make_approach(const Machine& machine, const Approach& approach,
                                            const double* share = nullptr,
                                            AxisShares* axis_shares = nullptr);

/// The jerk of one axis for the next tick.
/// @param share_kept  share of its largest speed that the axis does not exceed, even while its
///     acceleration returns to zero
[[nodiscard]] double approach_jerk(const Axis& axis, const AxisMotion& now, double target,
                                   double speed_share, double tick_s,
                                   double share_kept = 1) noexcept;

}  // namespace axg
