// SPDX-License-Identifier: Apache-2.0
// A program as the motion of a simulated board: the commanded positions, and drives that follow
// them with a lag.
#pragma once

#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/board/motion_board.hpp"
#include "hil_replay/motion/motion_sampler.hpp"

namespace axg {

// Time constant of a drive: the axis lags by this time at a steady speed. The lag averages the
// command, so the axis obeys every limit that the command obeys.
inline constexpr double kDriveLagS = 2e-3;

/// One tick is kMotionStepUs. `program`, `limits` and `options` must outlive the motion.
/// @param speed_share  MotionSampler::obey; null: the program's own speeds
/// @param axis_shares  the same with a share for each axis; null: no separate shares
/// @param lost_s  out, after each tick the seconds lost to the shares so far; may be null
[[nodiscard]] CommandedMotion make_program_motion(const Program& program,
                                                  const MotionLimits& limits,
                                                  const MotionOptions& options,
                                                  const double* speed_share = nullptr,
                                                  double* lost_s = nullptr,
                                                  AxisShares* axis_shares = nullptr);

/// Duration of that motion from its first tick to rest, s. Cost: computes every tick.
[[nodiscard]] double motion_seconds(const Program& program, const MotionLimits& limits,
                                    const MotionOptions& options);

}  // namespace axg
