// SPDX-License-Identifier: Apache-2.0
// What a stop is about, as JSON, the same for a replay and a drive. Its keys:
// docs/reference/commands.md.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "core/guard/monitor.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"

namespace axg {

/// Adds `pair`, `fault` and `limit` (units of the machine file), each where `reason` has one.
/// @param pair   kNoIndex: it is about none
/// @param fault  of reason input
/// @param limit  of reason left_limits
void add_stop_cause(const Machine& machine, StopReason reason, std::uint32_t pair,
                    ReceiverFault fault, const LimitFact& limit, nlohmann::ordered_json& out);

}  // namespace axg
