// SPDX-License-Identifier: Apache-2.0
// Whether a move stays inside the travel of every axis, its arc's outermost points included.
#pragma once

#include <vector>

#include "hil_replay/program.hpp"

namespace axg {

inline constexpr double kTravelSlack = 1e-9;  // mm or rad: rounding of unit conversions

/// Appends a fault with line, axis, value and limit for every axis that leaves its travel.
void check_travel(const Machine& machine, const AxisPositions& from, const Move& move,
                  std::vector<ProgramFault>& faults);

}  // namespace axg
