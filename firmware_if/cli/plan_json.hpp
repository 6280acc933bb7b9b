// SPDX-License-Identifier: Apache-2.0
// A cycle's plan as JSON: in results, and in a stored admission.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "core/machine/cycle_work.hpp"

namespace axg {

/// Each list by its name.
[[nodiscard]] nlohmann::ordered_json lists_json(const WorkLists& lists);

[[nodiscard]] nlohmann::ordered_json plan_json(const CyclePlan& plan);

/// The plan in such a value. Empty: it is none, or has no bound that an engine could reserve.
[[nodiscard]] std::optional<CyclePlan> plan_from_json(const nlohmann::ordered_json& value);

}  // namespace axg
