// SPDX-License-Identifier: Apache-2.0
// Data that a board with a cap for each axis exchanges with the planner of its motion. Source:
// docs/reference/board.md, "The cap".
#pragma once

#include <array>

#include "core/base/limits.hpp"

namespace axg {

/// Shares of each axis' largest speed. One planner writes, one board reads, in turn.
struct AxisShares {
    // From the board, read at every step: bound of each axis.
    std::array<double, kAxesMax> wanted{};
    // From the planner: largest speed of each axis on the rest of its path, if the axes obey
    // `wanted` as soon as the accelerations allow. Largest value since the board reset it.
    std::array<double, kAxesMax> needed{};
};

}  // namespace axg
