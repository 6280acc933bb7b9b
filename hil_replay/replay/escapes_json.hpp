// SPDX-License-Identifier: Apache-2.0
// The ways out of a place (hil_replay/replay/format_escapes.hpp) as JSON, for other NAME_json.cpp.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/guard/escape.hpp"

namespace axg {

/// One object a way: axis, direction, step_mm or step_deg, clearance_mm.
[[nodiscard]] nlohmann::ordered_json escapes_json(const Machine& machine, const Escapes& escapes);

}  // namespace axg
