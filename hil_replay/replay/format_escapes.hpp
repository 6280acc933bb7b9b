// SPDX-License-Identifier: Apache-2.0
// The ways out of a place (core/guard/escape.hpp) for reports: found, and in words.
#pragma once

#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/escape.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/replay/why_stop.hpp"

namespace axg {

/// As if the machine stood where the snapshot has it. Nothing is clear where memory ran out.
[[nodiscard]] Escapes find_escapes(const LoadedMachine& loaded, const Engine& engine,
                                   const ContainmentTest& containment_test,
                                   const AxisSnapshot& snapshot);

/// What one jog moves, mm or degrees.
[[nodiscard]] double step_in_file_units(const Machine& machine, const EscapeJog& jog);

/// "jog Z+ (1 mm: clearance at least 1.3000 mm)", the best first; or why there is none. In brief
/// the others without their figures. Empty: nothing is near.
[[nodiscard]] std::string format_escapes(const Machine& machine, const Escapes& escapes,
                                         Detail detail);

}  // namespace axg
