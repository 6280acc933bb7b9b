// SPDX-License-Identifier: Apache-2.0
// A replay by its arguments, for the commands `replay` and `verify`.
#pragma once

#include <cstdint>
#include <string>

#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"

namespace axg {

class NearestApproach;
struct ProgramLines;

struct ReplayArguments {
    MachineOptions machine;
    GcodeArguments gcode;  // program: empty unless --program
    std::string trace, engine, mode = "stoppable", csv, frames_out, report, device, lines, plan_of;
    std::int64_t deadline_us = 0;  // 0: the machine file's
    std::uint32_t multiprocessors = 0;
    double within_mm = 50.0;
    double arm_at_s = -1;  // negative: when it is ready
    double advice_s = 10;
    bool keep_going = false, lenient = false, is_realtime = false, has_details = false;
    JsonOutput json;
    // For a command that reports by itself; `replay` has no option for them.
    std::string title{};                          // instead of the trace's name; then it is quiet
    const ProgramLines* program_lines = nullptr;  // null: from the file beside the trace
    NearestApproach* approach = nullptr;          // null: not followed
};

/// Replays a trace that is no black box. Prints the report unless it has a title.
/// @param loaded  with the period and the format of the trace afterwards
/// @return  the exit code
[[nodiscard]] int replay_trace(const ReplayArguments& arguments, LoadedMachine& loaded,
                               const ReplayObserver& observer);

}  // namespace axg
