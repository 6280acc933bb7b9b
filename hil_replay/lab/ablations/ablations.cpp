// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/ablations/ablations.hpp"

#include <algorithm>
#include <iterator>

namespace axg::lab {

void forget_jerk_ramp(Machine& of_guard) noexcept {
    constexpr double kNoRamp = 1e18;  // acceleration changes at once
    for (Axis& axis : of_guard.axes) {
        axis.jerk_max = kNoRamp;
    }
}

void believe_any_turn(Machine& of_guard, std::uint32_t axis, double speed) noexcept {
    constexpr double kRoom = 1.25;  // for the checks of the path over longer strides
    const double period_s = of_guard.can.sample_us * 1e-6;
    of_guard.axes[axis].acceleration_max = kRoom * 2 * speed / period_s;
    of_guard.guard.free_jerk_limited = false;
}

void forget_dead_man(BoardOptions& board) noexcept {
    constexpr std::int64_t kNoEndUs = 1'000'000'000'000;  // eleven days
    board.permit_us = kNoEndUs;
}

void forget_what_was_kept(axg_board& board) noexcept {
    for (axg_board_record& record : board.records) {
        std::fill(std::begin(record.highest.of), std::end(record.highest.of), std::uint8_t{0});
    }
}

std::uint64_t forget_older_end(axg_board& board, std::int64_t period_us) noexcept {
    const std::uint64_t end_us = board.end_us;
    const auto soon_us = board.now_us + static_cast<std::uint64_t>(period_us) * 5 / 4;
    const bool has_older = board.has_end && board.last.is_given && board.last.end_us < end_us &&
                           board.last.end_us > soon_us;
    if (!has_older) {
        return 0;
    }
    board.end_us = board.last.end_us;
    return end_us;
}

void keep_end(axg_board& board, std::uint64_t end_us) noexcept {
    if (end_us != 0 && board.has_end) {
        board.end_us = std::max(board.end_us, end_us);
    }
}

}  // namespace axg::lab
