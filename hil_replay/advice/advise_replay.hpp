// SPDX-License-Identifier: Apache-2.0
// Finds settings with which a replayed trace stops nearer. Only stops about the distance of a pair
// have some, whatever their cause: reach, halving or full lists. A frozen axis, a late cycle and
// lost frames come from the board, the computer and the bus: no setting makes them harmless. A
// broken limit prints the measured value, which would be the true one.
//
// The trace shows the settings that do not change the motion; the simulated board runs the program,
// if it is known, with the others.
#pragma once

#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"
#include "hil_replay/replay/replay_run.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

struct ReplayAdvice {
    const LoadedMachine& loaded;  // as the replay had it
    Engine engine;
    const ContainmentTest& containment_test;
    const std::string& trace;
    const TraceOptions& options;
    bool lacks_session = false;   // AddedSession
    const LimitSurvey& seen;      // of the replay, up to the stop
    const StopEvent& stop;        // the first one
    const GcodeArguments& gcode;  // of the trace; no program: it is not driven
    double seconds = 0;           // of motion that may be run again before the stop
};
/// Empty: the stop is none of distance, the trace cannot be read twice, or its last part does not
/// stop at the same sample.
/// Cost: up to 5 runs of that part of the trace, and those of advise_drive.
[[nodiscard]] std::optional<Advice> advise_replay(const ReplayAdvice& advice);

}  // namespace axg
