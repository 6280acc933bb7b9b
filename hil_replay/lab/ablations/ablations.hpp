// SPDX-License-Identifier: Apache-2.0
// Ablations: a guard or a board made wrong on purpose, to show the effect of the missing part. Each
// one changes the data of a guard or a board, never code that is deployed.
#pragma once

#include "core/machine/machine.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg::lab {

/// Removes the jerk ramp from the guard's machine: the guard assumes that braking begins at once.
/// With `free_jerk_limited` such a guard bounds accelerations less tightly, so its reach is longer.
void forget_jerk_ramp(Machine& of_guard) noexcept;

/// Makes the guard accept any look-ahead path: in its machine, `axis` may reverse within one sample
/// period from any speed up to `speed` to the same speed back. mm/s or rad/s
void believe_any_turn(Machine& of_guard, std::uint32_t axis, double speed) noexcept;

/// Disables the board's dead-man: it moves on when its permit has ended.
void forget_dead_man(BoardOptions& board) noexcept;

/// Disables rule (iii) of docs/reference/board.md: clears the highest caps since each sample, so
/// that every usable permit counts. Call after each latch.
void forget_what_was_kept(axg_board& board) noexcept;

/// Disables rule (iv): a raise drops no permit. Call before a latch: sets the end in force to that
/// of the last permit, so that the library raises the cap without waiting.
/// @return  the previous end in force, for `keep_end` after the latch; 0 if unchanged
[[nodiscard]] std::uint64_t forget_older_end(axg_board& board, std::int64_t period_us) noexcept;
void keep_end(axg_board& board, std::uint64_t end_us) noexcept;

}  // namespace axg::lab
