// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/ablations/ablations.hpp"

namespace axg::lab {

void forget_jerk_ramp(Machine& of_guard) noexcept {
    constexpr double kNoRamp = 1e18;  // any change of acceleration takes no time
    for (Axis& axis : of_guard.axes) {
        axis.jerk_max = kNoRamp;
    }
}

void believe_any_turn(Machine& of_guard, std::uint32_t axis, double speed) noexcept {
    constexpr double kRoom = 1.25;  // for the longer strides that a path is also checked over
    const double period_s = of_guard.can.sample_us * 1e-6;
    of_guard.axes[axis].acceleration_max = kRoom * 2 * speed / period_s;
    of_guard.guard.free_jerk_limited = false;
}

void forget_dead_man(BoardOptions& board) noexcept {
    constexpr std::int64_t kNoEndUs = 1'000'000'000'000;  // eleven days
    board.permit_us = kNoEndUs;
}

}  // namespace axg::lab
