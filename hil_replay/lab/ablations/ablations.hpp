// SPDX-License-Identifier: Apache-2.0
// Ablations: a guard or a board made wrong on purpose, to show what the missing part is for. Each
// one changes the data that a guard or a board receives, never code that is deployed.
#pragma once

#include "core/machine/machine.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg::lab {

/// The machine of a guard that forgets the jerk ramp: it supposes that braking sets in at once.
/// Where `free_jerk_limited` holds, such a guard knows accelerations less well, and is longer.
void forget_jerk_ramp(Machine& of_guard) noexcept;

/// The machine of a guard that believes any look-ahead path: `axis` is said to turn within one
/// sample from any speed up to `speed` to the same speed back. mm/s or rad/s
void believe_any_turn(Machine& of_guard, std::uint32_t axis, double speed) noexcept;

/// A board without the dead man: it moves on when its permit has run out.
void forget_dead_man(BoardOptions& board) noexcept;

}  // namespace axg::lab
