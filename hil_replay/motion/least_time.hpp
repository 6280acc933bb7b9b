// SPDX-License-Identifier: Apache-2.0
// A lower bound of a program's duration, computed only from its moves: enough to refuse a day of
// dwell before any output. The motion itself is longer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hil_replay/motion/motion_limits.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

/// The first move that raises the lower bound above `seconds_max`; moves.size() if none does. A
/// dwell counts in full. A move counts half of its time at full speed or at its feed: blended
/// corners shorten it by no more. Moves under tool centre point control count 0 s.
/// Cost: a few operations per move.
[[nodiscard]] std::size_t first_move_beyond(const Program& program, const MotionLimits& limits,
                                            double seconds_max);

/// The message for a program whose motion has more than `samples_max` samples.
[[nodiscard]] std::string too_many_samples(std::uint64_t samples_max);

}  // namespace axg
