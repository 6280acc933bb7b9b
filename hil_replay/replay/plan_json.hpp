// SPDX-License-Identifier: Apache-2.0
// A cycle's plan as JSON, for results.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/machine/cycle_work.hpp"

namespace axg {

[[nodiscard]] nlohmann::ordered_json plan_json(const CyclePlan& plan);

}  // namespace axg
