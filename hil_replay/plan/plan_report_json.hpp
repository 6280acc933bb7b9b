// SPDX-License-Identifier: Apache-2.0
// The key "plan" of `axguard check --plan --json`, as text.
#pragma once

#include <cstdint>
#include <string>

#include "hil_replay/plan/plan_report.hpp"

namespace axg {

struct ModelChoice;

[[nodiscard]] std::string describe_plan(const ModelChoiceOptions& options, std::int64_t deadline_us,
                                        const ModelChoice& choice);

}  // namespace axg
