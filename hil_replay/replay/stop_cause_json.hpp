// SPDX-License-Identifier: Apache-2.0
// Cause of a stop and the ways out of it, as JSON, the same for a replay and a drive. Keys:
// docs/reference/json.md.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "core/guard/escape.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "hil_replay/trace/program_lines.hpp"

namespace axg {

/// Adds `pair`, `fault` and `limit` (units of the machine file), each where `reason` has one.
/// @param pair   kNoIndex: the stop concerns no pair
/// @param fault  of reason input
/// @param limit  of a reason that has one
void add_stop_cause(const Machine& machine, StopReason reason, std::uint32_t pair,
                    ReceiverFault fault, const LimitFact& limit, nlohmann::ordered_json& out);

/// Adds `program_line` and `program_block`, where a table has a step at this instant.
void add_program_line(const ProgramLines& lines, std::int64_t time_us, nlohmann::ordered_json& out);

/// Keys: docs/reference/json.md.
[[nodiscard]] nlohmann::ordered_json why_json(const Machine& machine, const StopWhy& why);
/// The same with `sentences`, for a page: documents have none.
[[nodiscard]] nlohmann::ordered_json page_why_json(const Machine& machine, const StopWhy& why);

/// One object a way out: axis, direction, step_mm or step_deg, clearance_mm.
[[nodiscard]] nlohmann::ordered_json escapes_json(const Machine& machine, const Escapes& escapes);

}  // namespace axg
