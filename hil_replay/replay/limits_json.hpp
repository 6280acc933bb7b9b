// SPDX-License-Identifier: Apache-2.0
// The table of limits (limit_table.hpp) as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/machine/machine.hpp"
#include "hil_replay/trace/limit_survey.hpp"

namespace axg {

[[nodiscard]] nlohmann::ordered_json limits_json(const Machine& machine, const LimitSurvey& survey);
[[nodiscard]] nlohmann::ordered_json proposed_limits_json(const Machine& machine,
                                                          const LimitSurvey& survey);

}  // namespace axg
