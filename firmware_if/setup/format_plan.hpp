// SPDX-License-Identifier: Apache-2.0
// A cycle's plan in words, and as a machine file pins it.
#pragma once

#include <string>

#include "core/machine/cycle_work.hpp"

namespace axg {

/// "node_pairs: 192, leaf_pairs: 240, ...".
[[nodiscard]] std::string format_lists(const WorkLists& lists);

/// "3 stages, 544 queries after the first; lists: 512 node pairs, ...".
[[nodiscard]] std::string format_plan(const CyclePlan& plan);

/// "cycle: {stages: 3, queries: 512, lists: {...}}".
[[nodiscard]] std::string format_plan_key(const CyclePlan& plan);

}  // namespace axg
