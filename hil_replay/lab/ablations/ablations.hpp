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

/// Rule (iii) of docs/reference/board.md left out: the board forgets what it kept since its
/// samples, so that every usable permit counts. After each latch.
void forget_what_was_kept(axg_board& board) noexcept;

/// Rule (iv) left out: a raise shortens nothing. Before a latch: what the library takes for the end
/// of the permit in force is that of the last one, so that it waits for nothing.
/// @return  the end in force, for `keep_end` after the latch; 0: nothing was changed
[[nodiscard]] std::uint64_t forget_older_end(axg_board& board, std::int64_t period_us) noexcept;
void keep_end(axg_board& board, std::uint64_t end_us) noexcept;

}  // namespace axg::lab
