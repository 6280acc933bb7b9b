// SPDX-License-Identifier: Apache-2.0
// A motion that means harm within the law: every axis makes for its target as fast as its limits
// let it, and ends there at rest. What a program might ask for at worst.
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

/// Speed, acceleration and jerk keep the axis' limits at every instant, and so would the speed if
/// the acceleration had to go to zero from there. `machine` must outlive the motion.
/// @param share  of each axis' largest speed, read at every tick, that it may have at most; null:
///     all of it
/// @param axis_shares  the same with a share for each axis; null: none has one of its own
[[nodiscard]] CommandedMotion make_approach(const Machine& machine, const Approach& approach,
                                            const double* share = nullptr,
                                            AxisShares* axis_shares = nullptr);

/// The jerk of one axis for the next tick.
/// @param share_kept  of its largest speed, that it does not exceed even while its acceleration
///     returns to zero
[[nodiscard]] double approach_jerk(const Axis& axis, const AxisMotion& now, double target,
                                   double speed_share, double tick_s,
                                   double share_kept = 1) noexcept;

}  // namespace axg
