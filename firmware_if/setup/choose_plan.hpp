// SPDX-License-Identifier: Apache-2.0
// The lists that a cycle may use on this processor: the largest of a fixed shape whose longest
// cycle, constructed and measured, fits the engine's share of the deadline.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/guard/time_limits.hpp"
#include "core/machine/cycle_work.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/measure_cycle.hpp"

namespace axg {

/// Lists in a fixed shape: leaves 1, nodes 1, rows 4, triangles 8, no rechecks.
struct PlanScale {
    std::uint32_t stages = 2;
    std::uint32_t leaf_pairs = 512;
};
inline constexpr std::uint32_t kPlanQueries = 510;  // of the later stages
// A quarter of the default, and never fewer: below, not even clear positions are proven.
inline constexpr std::uint32_t kLeafPairsMin = 64;

/// @param tasks  pairs with each tool (stop_tasks)
[[nodiscard]] CyclePlan plan_at(const PlanScale& scale, std::uint32_t tasks) noexcept;

/// Those of all stages together.
[[nodiscard]] WorkLists lists_in(const CyclePlan& plan) noexcept;

/// "2 stages, 24 and 510 queries, lists 512 node pairs, ...".
[[nodiscard]] std::string to_text(const CyclePlan& plan);

struct ChosenPlan {
    CyclePlan plan;
    bool is_fit = false;
    double longest_us = 0, room_us = 0;  // of its longest cycle; the engine's share of the deadline
    double posing_us = 0;                // of that
    std::int64_t least_deadline_us = 0;  // at which it, or the floor, would fit
    std::string words;                   // what was measured and chosen, or why nothing may run
};

/// Takes some seconds. Empty, with `fault` set: it could not be measured.
/// @param pinned  that of the machine file: it alone is measured and judged
[[nodiscard]] std::optional<ChosenPlan> choose_plan(const LoadedMachine& loaded,
                                                    const std::optional<CyclePlan>& pinned,
                                                    std::string& fault);

}  // namespace axg
