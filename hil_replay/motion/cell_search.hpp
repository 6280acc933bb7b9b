// SPDX-License-Identifier: Apache-2.0
// Finds the place of a clock in the plan of a run. mm of path.
#pragma once

#include <cstddef>
#include <vector>

#include "hil_replay/motion/motion_plan.hpp"

namespace axg {

/// The cell that contains `mm`, or the last. Precondition: it is `from` or a later one.
[[nodiscard]] inline std::size_t cell_at(const std::vector<Cell>& cells, std::size_t from,
                                         double mm) noexcept {
    while (from + 1 < cells.size() && cells[from + 1].start_mm <= mm) {
        ++from;
    }
    return from;
}

}  // namespace axg
