// SPDX-License-Identifier: Apache-2.0
// The plan of a cycle, for the code that proves, measures or reports cycles.
// Source: docs/theory/certificate.md, "Stages and groups".
#pragma once

#include <cstdint>

#include "core/machine/cycle_work.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The plan that the machine file states, or the usual one.
/// @param tasks  pairs that one cycle may have to prove (stop_tasks)
[[nodiscard]] constexpr CyclePlan default_plan(const Machine& machine,
                                               std::uint32_t tasks) noexcept {
    const CycleRules& rules = machine.cycle;
    return plan_of(rules.stages, tasks, rules.queries, rules.lists);
}

/// The plan in force: all parts of a guard use this one.
[[nodiscard]] constexpr CyclePlan cycle_plan(const Machine& machine, std::uint32_t tasks) noexcept {
    return machine.plan ? *machine.plan : default_plan(machine, tasks);
}

}  // namespace axg
