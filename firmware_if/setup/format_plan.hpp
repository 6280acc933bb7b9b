// SPDX-License-Identifier: Apache-2.0
// A cycle's plan in words.
#pragma once

#include <string>

#include "core/machine/cycle_work.hpp"

namespace axg {

/// "2 stages, 510 questions after the first, lists of 512 pairs of nodes, ...".
[[nodiscard]] std::string format_plan(const CyclePlan& plan);

}  // namespace axg
