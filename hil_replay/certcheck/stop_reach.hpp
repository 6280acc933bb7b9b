// SPDX-License-Identifier: Apache-2.0
// How far an axis goes on after a stop begins, by the machine's promise to stop each axis itself.
#pragma once

#include <cstdint>

#include "hil_replay/certcheck/model.hpp"

namespace axg::certcheck {

/// An upper bound in units, one way, for a command whose speed is at most speed / 255 of the axis'.
/// @param following most that the axis is off its command, units
/// @throws Refusal 10 where it exceeds 2^44 units
[[nodiscard]] std::int64_t stop_reach(const Model& model, const Axis& axis, std::int64_t following,
                                      int speed);

}  // namespace axg::certcheck
