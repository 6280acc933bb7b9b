// SPDX-License-Identifier: Apache-2.0
// Moves the axes away from an obstacle jog by jog, each along the best way out and with the guard
// on the wire, until any other motion is permitted. mm, rad.
#pragma once

#include <string>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/reach/jog.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/drive/drive_run.hpp"

namespace axg {

inline constexpr double kJogSteps = 5;         // of core/guard/escape.hpp, in one jog
inline constexpr std::uint32_t kJogsMax = 20;  // then it gives up

struct JogDone {
    JogMove move;
    double moved = 0;         // mm or rad
    double clearance_mm = 0;  // lower bound for every pair afterwards, up to kEscapeWithinMm
    bool is_stopped = false;  // by the guard, before its end
};

struct JogOut {
    std::vector<JogDone> jogs;
    bool is_out = false;  // any motion is permitted from there (path_keeping: all margins hold)
    AxisSnapshot rest;    // where it ends
};

/// Guard and board begin anew for each jog, as after a restart.
/// @param options  of the stopped drive; its faults are not repeated
[[nodiscard]] JogOut jog_out(const LoadedMachine& loaded, const Engine& engine,
                             const ContainmentTest& containment_test, const AxisSnapshot& from,
                             const DriveOptions& options);

/// "jogged Z+ 5.0000 mm (clear by at least 2.3000 mm), ...", and whether it is out.
[[nodiscard]] std::string jog_out_text(const Machine& machine, const JogOut& out);

}  // namespace axg
