// SPDX-License-Identifier: Apache-2.0
// The key "plan" of `axguard check --plan --json`, as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware_if/setup/choose_plan.hpp"
#include "hil_replay/plan/plan_report.hpp"

namespace axg {

struct ModelChoice;

/// @param cycle  its lists on the CPU; empty: not measured
[[nodiscard]] std::string describe_plan(const ModelChoiceOptions& options, std::int64_t deadline_us,
                                        const ModelChoice& choice,
                                        const std::optional<ChosenPlan>& cycle);

}  // namespace axg
