// SPDX-License-Identifier: Apache-2.0
// How long a program takes at least, from its moves alone: enough to refuse a day of dwell before a
// byte of it is written. The motion itself takes longer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "hil_replay/motion/motion_limits.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

/// The move at which the program has taken longer than `seconds_max`; moves.size(): it may take
/// less. A dwell counts in full. A move counts half of its time at full speed, or at its feed, for
/// a blended corner cuts no more of it. Moves of a tip count nothing.
/// Cost: a few operations a move.
[[nodiscard]] std::size_t first_move_beyond(const Program& program, const MotionLimits& limits,
                                            double seconds_max);

/// What is wrong with a program whose motion has more samples than it may have.
[[nodiscard]] std::string too_many_samples(std::uint64_t samples_max);

}  // namespace axg
