// SPDX-License-Identifier: Apache-2.0
// What a board that keeps a cap of its own for each axis and the planner of its motion tell each
// other. Source: docs/reference/board.md, "The cap".
#pragma once

#include <array>

#include "core/base/limits.hpp"

namespace axg {

/// Shares of each axis' largest speed. One planner writes, one board reads, in turn.
struct AxisShares {
    // From the board, read at every step: what each axis may have.
    std::array<double, kAxesMax> wanted{};
    // From the planner: what each axis has at most from now on, as its path goes on, if all that is
    // wanted is kept as soon as the accelerations allow. The largest since the board took it.
    std::array<double, kAxesMax> needed{};
};

}  // namespace axg
