// SPDX-License-Identifier: Apache-2.0
// Finds the ways out of a position (core/guard/escape.hpp) and formats them for reports.
#pragma once

#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/guard/escape.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "firmware_if/explain/why_sentences.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Finds the ways out for a machine at rest at the snapshot. Default result if memory ran out.
[[nodiscard]] Escapes find_escapes(const LoadedMachine& loaded, const Engine& engine,
                                   const ContainmentTest& containment_test,
                                   const AxisSnapshot& snapshot);

/// Distance of one jog, mm or degrees.
[[nodiscard]] double step_in_file_units(const Machine& machine, const EscapeJog& jog);

/// "jog Z+ (1 mm: clearance at least 1.3000 mm)", the best first; or why there is none. In brief
/// only the first has its figures. Empty: no pair is near.
[[nodiscard]] std::string format_escapes(const Machine& machine, const Escapes& escapes,
                                         Detail detail);

}  // namespace axg
