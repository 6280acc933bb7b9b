// SPDX-License-Identifier: Apache-2.0
// The lists that a cycle may use on this processor: the longest whose longest cycle, constructed
// and measured, fits the engine's share of the deadline.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/guard/time_limits.hpp"
#include "core/machine/cycle_work.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/measure_cycle.hpp"

namespace axg {

/// The plan of the machine file with its lists shortened or lengthened: step kPlanStepAsStated has
/// them as stated. Lower steps shorten triangles first and rows last: a row proves most for its
/// time (docs/measurements/bounded-cycle.md).
inline constexpr std::uint32_t kPlanSteps = 7, kPlanStepAsStated = 3;
/// @param tasks  pairs with each tool (stop_tasks)
/// @param step   below kPlanSteps
[[nodiscard]] CyclePlan plan_at(const Machine& machine, std::uint32_t tasks, std::uint32_t step);

struct ChosenPlan {
    CyclePlan plan;
    bool is_fit = false;
    double longest_us = 0, room_us = 0;  // of its longest cycle; the engine's share of the deadline
    double posing_us = 0;                // of that
    std::int64_t least_deadline_us = 0;  // at which it, or the floor, would fit
    std::string words;                   // what was measured and chosen, or why nothing may run
};

/// Needs some seconds. If the machine file pins a plan, measures and judges only that one.
/// Empty, with `fault` set: it could not be measured.
[[nodiscard]] std::optional<ChosenPlan> choose_plan(const LoadedMachine& loaded,
                                                    std::string& fault);

/// The same for this plan, whatever the machine file states.
[[nodiscard]] std::optional<ChosenPlan> judge_plan(const LoadedMachine& loaded,
                                                   const CyclePlan& plan, std::string& fault);

}  // namespace axg
