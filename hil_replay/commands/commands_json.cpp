// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/commands_json.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "firmware_if/cli/document_json.hpp"
#include "firmware_if/cli/plan_json.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/replay/black_box_file.hpp"
#include "hil_replay/replay/black_box_replay.hpp"
#include "hil_replay/replay/limits_json.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/stop_cause_json.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json describe_ids(const std::map<IdKey, IdSurvey>& ids) {
    auto out = Json::array();
    for (const auto& [key, survey] : ids) {
        out.push_back({{"id", key.id},
                       {"name", name_of(key)},
                       {"extended", key.is_extended},
                       {"remote", key.is_remote},
                       {"fd", key.is_fd},
                       {"error", key.is_error},
                       {"frames", survey.frames},
                       {"bytes_min", survey.bytes_min},
                       {"bytes_max", survey.bytes_max},
                       {"first_us", survey.first_us},
                       {"last_us", survey.last_us},
                       {"per_second", per_second(survey)},
                       {"period_us_median", survey.period_us_median},
                       {"period_us_p1", survey.period_us_p1},
                       {"period_us_p99", survey.period_us_p99},
                       {"longest_us", survey.longest_us},
                       {"longest_at_us", survey.longest_at_us},
                       {"gaps", survey.gaps}});
    }
    return out;
}

Json describe_axes(const Machine& machine, const SnapshotSurvey& survey) {
    Json out;
    out["name"] = machine.name;
    out["snapshots"] = survey.snapshots;
    out["samples_lost"] = survey.samples_lost;
    out["tools"] = survey.tools;
    auto& axes = out["axes"] = Json::array();
    for (std::size_t i = 0; i < machine.axes.size() && survey.snapshots > 0; ++i) {
        const Axis& axis = machine.axes[i];
        const AxisSurvey& seen = survey.axes[i];
        axes.push_back({{"name", axis.name},
                        {"unit", axis.kind == AxisKind::rotary ? "deg" : "mm"},
                        {"least", shown_value(axis, seen.least)},
                        {"most", shown_value(axis, seen.most)},
                        {"last", shown_value(axis, seen.last)},
                        {"fastest_per_min", 60 * shown_value(axis, seen.speed_max)}});
    }
    auto& faults = out["receiver_faults"] = Json::object();
    for (std::uint32_t i = 0; i < kReceiverFaults; ++i) {
        const auto fault = static_cast<ReceiverFault>(i);
        if (survey.counters.of(fault) > 0 && fault != ReceiverFault::none) {
            faults[fault_row(fault).name] = survey.counters.of(fault);
        }
    }
    return out;
}

Json describe_reading(const GcodeResult& result) {
    Json document;
    document["lines"] = result.line_count;
    document["moves"] = result.program.moves.size();
    document["tool_changes"] = result.tool_changes;
    auto& ignored = document["ignored"] = Json::array();
    for (const IgnoredWord& word : result.ignored) {
        ignored.push_back({{"line", word.line}, {"word", word.word}, {"text", word.text}});
    }
    auto& faults = document["faults"] = Json::array();
    for (const ProgramFault& fault : result.faults) {
        faults.push_back({{"line", fault.line}, {"word", fault.word}, {"message", fault.message}});
    }
    document["more_faults"] = result.has_more_faults;
    document["notes"] = result.notes;
    document["read_as"] = result.read_as;
    return document;
}

Json describe_motion(const SimulationSummary& summary, const Machine& machine) {
    Json document;
    document["program_s"] = summary.program_s;
    document["path_mm"] = summary.path_mm;
    document["samples"] = summary.samples;
    document["frames"] = summary.frames;
    document["standstills"] = summary.runs;
    document["blended_corners"] = summary.blends;
    auto& axes = document["axes"] = Json::array();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const LimitMeter::Peak& peak = summary.peaks[i];
        axes.push_back({{"name", axis.name},
                        {"speed_share", peak.speed / axis.speed_max},
                        {"acceleration_share", peak.acceleration / axis.acceleration_max},
                        {"jerk_share", peak.jerk / axis.jerk_max}});
    }
    return document;
}

Json describe(const BlackBoxComparison& all) {
    return {{"same", all.same}, {"different", all.different}, {"run_in", all.run_in}};
}

Json describe_json(const std::optional<BlackBoxStop>& stop, const Machine& machine) {
    if (!stop) {
        return nullptr;
    }
    Json out{{"cause", to_text(stop->cause)},
             {"reason", to_text(stop->reason)},
             {"time_us", stop->time_us}};
    out["pair"] =
        stop->pair < machine.pairs.size() ? Json(pair_name(machine, stop->pair)) : Json(nullptr);
    if (stop->cause == GuardFault::verdict) {
        out["latched_us"] = stop->latched_us;
    }
    if (stop->cause == GuardFault::input) {
        out["fault"] = fault_row(stop->fault).name;
    }
    return out;
}

}  // namespace

std::string describe_compile(const CompileReport& report) {
    return text_of({{"file", report.file},
                    {"compiled_from", report.source},
                    {"name", report.name},
                    {"triangles", report.triangles},
                    {"bytes", report.size_bytes}});
}

std::string describe_inspect(const InspectReport& report) {
    const TraceEnd end = end_of(report.trace);
    Json document{{"trace", report.file},
                  {"valid", end.fault.empty()},
                  {"device", report.trace.device()},
                  {"frames", report.survey.frame_count()},
                  {"seconds", report.seconds},
                  {"lines_skipped", end.lines_skipped},
                  {"ids", describe_ids(report.ids)}};
    if (!end.fault.empty()) {
        document["fault"] = end.fault;
    }
    if (end.lines_skipped != 0) {
        document["first_skipped"] = end.first_skipped;
    }
    if (report.machine != nullptr) {
        document["machine"] = describe_axes(*report.machine, report.survey.snapshots());
        document["machine"]["limits"] = limits_json(*report.machine, report.survey.limits());
        if (report.proposes_limits) {
            document["machine"]["proposed_limits"] =
                proposed_limits_json(*report.machine, report.survey.limits());
        }
    }
    return text_of(document);
}

std::string describe_simulate(const SimulateReport& report, const Machine& machine,
                              const SimulationSummary* summary) {
    Json document{{"program", report.program},
                  {"trace", report.trace},
                  {"sample_us", report.sample_us},
                  {"axis_by_axis", report.is_axis_by_axis},
                  {"reading", describe_reading(report.reading)}};
    if (summary != nullptr) {
        document["motion"] = describe_motion(*summary, machine);
    }
    return text_of(document);
}

std::string describe_black_box(const BlackBoxReport& report) {
    const BlackBoxHeader& header = report.black_box.header();
    const ReplayedBlackBox& result = report.result;
    const Machine& machine = report.machine;
    Json out{{"black_box", report.file},
             {"machine", machine.name},
             {"mode", header.is_stoppable ? "stoppable" : "contact"},
             {"configuration_sha256",
              std::string_view(header.configuration.data(), header.configuration.size())},
             {"unix_us", header.unix_us},
             {"records", result.records},
             {"records_lost", result.lost},
             {"first_us", result.first_us},
             {"last_us", result.last_us},
             {"frames_read", result.frames_read},
             {"frames_sent", result.frames_sent},
             {"frames_refused", result.frames_refused},
             {"echoes", result.echoes}};
    if (header.is_stoppable) {
        out["plan"] = plan_json(header.plan);
    }
    out["snapshots"] = describe(result.snapshots);
    out["verdicts"] = describe(result.verdicts);
    out["recorded"] = describe_json(result.recorded, machine);
    out["replayed"] = describe_json(result.replayed, machine);
    const TimeHistogram& times = result.permit_time;
    const auto us = [&times](double share) { return times.at_share_ns(share) / 1000; };
    out["permit_us"] = {{"count", times.count()},
                        {"p50", us(0.5)},
                        {"p90", us(0.9)},
                        {"p99", us(0.99)},
                        {"max", us(1.0)}};
    out["stop_us"] = result.stop_us >= 0 ? Json(result.stop_us) : Json(nullptr);
    out["sent"] = result.sent
                      ? Json{{"same", result.sent->same}, {"different", result.sent->different}}
                      : Json(nullptr);
    out["is_reproduced"] = can_be_reproduced(result) ? Json(is_reproduced(result)) : Json(nullptr);
    if (result.refused) {
        add_program_line(report.lines, result.refused->snapshot.arrived_us, out);
    }
    out["why"] = report.why ? why_json(machine, *report.why) : Json(nullptr);
    out["damage"] = report.black_box.error();
    return text_of(out);
}

double number_at(const std::string& document, const char* pointer) {
    const Json whole = Json::parse(document, nullptr, false);
    const Json::json_pointer place(pointer);
    return !whole.is_discarded() && whole.contains(place) && whole.at(place).is_number()
               ? whole.at(place).get<double>()
               : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace axg
