// SPDX-License-Identifier: Apache-2.0
// A program as the motion of a simulated board: the commanded positions, and drives that follow
// them a little late.
#pragma once

#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/board/motion_board.hpp"
#include "hil_replay/motion/motion_sampler.hpp"

namespace axg {

// Time constant of a drive: the axis is this far behind at a steady speed. The lag averages the
// command, so it keeps every limit that the command keeps.
inline constexpr double kDriveLagS = 2e-3;

/// One tick is kMotionStepUs. `program`, `limits` and `options` must outlive the motion.
/// @param speed_share  MotionSampler::obey; null: the program's own speeds
/// @param axis_shares  the same with a share for each axis; null: none has one of its own
/// @param lost_s  takes after each tick how many seconds that has cost; null: nobody wants to know
[[nodiscard]] CommandedMotion make_program_motion(const Program& program,
                                                  const MotionLimits& limits,
                                                  const MotionOptions& options,
                                                  const double* speed_share = nullptr,
                                                  double* lost_s = nullptr,
                                                  AxisShares* axis_shares = nullptr);

/// How long that motion takes from its first tick to rest, s. Cost: every tick of it.
[[nodiscard]] double motion_seconds(const Program& program, const MotionLimits& limits,
                                    const MotionOptions& options);

}  // namespace axg
