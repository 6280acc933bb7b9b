// SPDX-License-Identifier: Apache-2.0
// Reports a replay: in brief, or with the table of times as the seed paper prints it; the stop as
// text; and the same as JSON.
#pragma once

#include <cstdio>
#include <map>
#include <string>

#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/replay/replay_run.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "hil_replay/trace/program_lines.hpp"
#include "hil_replay/trace/trace_period.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {

struct ReplayReport {
    const LoadedMachine& loaded;
    CpuEngine& engine;  // queried again about the stop: triangles, clearances
    const ContainmentTest& containment_test;
    const ReplayRun& run;
    std::int64_t deadline_us;
    const std::string& trace;
    std::string gpu{};      // which one ran; empty: the CPU engine
    std::string plan_of{};  // the stored admission that states the plan; empty: the machine file
    bool is_realtime = false;
    TraceEnd end{};
    ProgramLines lines{};  // empty: no table of them
    TracePeriod period{};  // the declared one, and the one that the trace shows
    // Explains the run's stops that concern a pair, and the first sample withheld.
    std::map<const StopEvent*, StopWhy> whys{};
};
/// Fills in `whys`; call before printing. Cost: one why_of a stop.
void explain_stops(ReplayReport& report);

void print_replay(const ReplayReport& report, Detail detail, std::FILE* words);

struct ReplayDocument {
    std::string text;
    std::string stops;  // of the document, in one line
};
[[nodiscard]] ReplayDocument describe_replay(const ReplayReport& report);
/// Returns the document for a trace of which no frame could be read.
[[nodiscard]] std::string describe_unread(const std::string& trace, const std::string& fault);

}  // namespace axg
