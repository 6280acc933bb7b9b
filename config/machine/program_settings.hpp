// SPDX-License-Identifier: Apache-2.0
// The section `program` of a machine file: settings of the control that decide what a program
// means. Nothing of it reaches the guard, its proofs or its hashes. mm and rad.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/machine/machine.hpp"

namespace axg {

struct MachineText;

/// Where an absolute word takes an endless axis.
enum class RotaryRule : std::uint8_t {
    unknown,
    programmed,  // to that position, turn by turn
    shortest,    // less than half a turn
    wrapped,     // LinuxCNC's WRAPPED_ROTARY: to the angle, up or, with a minus, down
};

/// A position of the control; an axis that the file does not state is empty. By axis.
using StoredPosition = std::array<std::optional<double>, kAxesMax>;

struct ProgramSettings {
    std::optional<bool> starts_in_inch;
    std::array<RotaryRule, kAxesMax> rotary{};
    StoredPosition g28{}, g30{};  // machine coordinates
    std::string startup_code;     // runs before each program
    // LinuxCNC 2.9, interp_internal.hh, CENTER_ARC_RADIUS_TOLERANCE_MM and _INCH: what centres and
    // ends rounded to 0.01 mm or 0.001 in cause.
    double arc_tolerance_mm = 0.028284271247461901;
    double arc_tolerance_inch = 0.0028284271247461901;
    bool takes_program_numbers = true;  // `O1001` alone
};

/// The section of a machine file that parse_machine() read without fault.
[[nodiscard]] ProgramSettings program_settings(const MachineText& source, const Machine& machine);

}  // namespace axg
