// SPDX-License-Identifier: Apache-2.0
// The documents that compile, inspect, simulate and the replay of a black box write with --json, as
// text.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "hil_replay/trace/trace_survey.hpp"

namespace axg {

class BlackBoxFile;
class TraceReader;
struct GcodeResult;
struct ProgramLines;
struct ReplayedBlackBox;
struct SimulationSummary;
struct StopWhy;

struct CompileReport {
    const std::string &file, &source, &name;
    std::size_t triangles, size_bytes;
};
[[nodiscard]] std::string describe_compile(const CompileReport& report);

struct InspectReport {
    const std::string& file;
    const TraceReader& trace;
    const TraceSurvey& survey;
    double seconds;
    const std::map<IdKey, IdSurvey>& ids;
    const Machine* machine;  // null: identifiers alone
    bool proposes_limits = false;
};
[[nodiscard]] std::string describe_inspect(const InspectReport& report);

struct SimulateReport {
    const std::string &program, &trace;
    std::uint32_t sample_us;
    bool is_axis_by_axis;
    const GcodeResult& reading;
};
/// @param summary  null: nothing was simulated
[[nodiscard]] std::string describe_simulate(const SimulateReport& report, const Machine& machine,
                                            const SimulationSummary* summary);

struct BlackBoxReport {
    const std::string& file;
    const Machine& machine;
    const BlackBoxFile& black_box;
    const ReplayedBlackBox& result;
    const std::optional<StopWhy>& why;  // of result.refused
    const ProgramLines& lines;          // empty: no program
};
[[nodiscard]] std::string describe_black_box(const BlackBoxReport& report);

/// The number at a JSON pointer of a document; NaN: there is none.
[[nodiscard]] double number_at(const std::string& document, const char* pointer);

}  // namespace axg
