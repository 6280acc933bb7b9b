// SPDX-License-Identifier: Apache-2.0
// axguard inspect: prints the contents of a recorded bus; needs no guard.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "config/compiled/compiled_machine.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "hil_replay/commands/black_box_command.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/commands_json.hpp"
#include "hil_replay/replay/limit_table.hpp"
#include "hil_replay/replay/replay_report.hpp"
#include "hil_replay/trace/kept_input.hpp"
#include "hil_replay/trace/trace_period.hpp"
#include "hil_replay/trace/trace_survey.hpp"

namespace axg {
namespace {

struct InspectArguments {
    std::string trace, machine, device;
    bool lenient = false, proposes_limits = false;
    JsonOutput json;
};

void print_ids(std::FILE* out, const std::map<IdKey, IdSurvey>& ids, std::int64_t start_us) {
    fmt::print(out, "{:12} {:>8} {:>6} {:>9} | period, ms {:>7} {:>8} {:>8} {:>8} {:>6}\n", "id",
               "frames", "bytes", "a second", "median", "p1", "p99", "longest", "gaps");
    for (const auto& [key, survey] : ids) {
        const std::string bytes = survey.bytes_min == survey.bytes_max
                                      ? fmt::format("{}", survey.bytes_max)
                                      : fmt::format("{}-{}", survey.bytes_min, survey.bytes_max);
        fmt::print(out, "{:12} {:>8} {:>6} {:>9.1f} | ", name_of(key), survey.frames, bytes,
                   per_second(survey));
        if (survey.frames < 2) {
            fmt::print(out, "once, at {:.6f} s\n",
                       static_cast<double>(survey.first_us - start_us) * 1e-6);
            continue;
        }
        const auto ms = [](std::int64_t us) { return static_cast<double>(us) * 1e-3; };
        fmt::print(out, "{:>18.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>6}", ms(survey.period_us_median),
                   ms(survey.period_us_p1), ms(survey.period_us_p99), ms(survey.longest_us),
                   survey.gaps);
        if (survey.gaps > 0) {
            fmt::print(out, "  the longest from {:.6f} s",
                       static_cast<double>(survey.longest_at_us - start_us) * 1e-6);
        }
        fmt::print(out, "\n");
    }
}

void print_axes(std::FILE* out, const Machine& machine, const SnapshotSurvey& survey) {
    fmt::print(out, "\n{}: {} complete samples, {} lost\n", machine.name, survey.snapshots,
               survey.samples_lost);
    if (survey.snapshots == 0) {
        fmt::print(out, "no axis frames of this machine. List its frames with axguard check.\n");
    } else {
        fmt::print(out, "{:5} {:>12} {:>12} {:>12} {:>14}\n", "axis", "least", "most", "last",
                   "fastest, /min");
    }
    for (std::size_t i = 0; i < machine.axes.size() && survey.snapshots > 0; ++i) {
        const Axis& axis = machine.axes[i];
        const AxisSurvey& seen = survey.axes[i];
        const char* const unit = axis.kind == AxisKind::rotary ? "deg" : "mm";
        fmt::print(out, "{:5} {:>12.4f} {:>12.4f} {:>12.4f} {:>14.1f} {}{}\n", axis.name,
                   shown_value(axis, seen.least), shown_value(axis, seen.most),
                   shown_value(axis, seen.last), 60 * shown_value(axis, seen.speed_max), unit,
                   axis.unlimited ? ", within one turn" : "");
    }
    for (std::uint32_t i = 0; i < kReceiverFaults; ++i) {
        const auto fault = static_cast<ReceiverFault>(i);
        if (survey.counters.of(fault) > 0 && fault != ReceiverFault::none) {
            fmt::print(out, "{} x {}: {}\n", survey.counters.of(fault), fault_row(fault).name,
                       fault_row(fault).meaning);
        }
    }
}

/// Empty: the file is none.
std::string black_box_fault(const std::string& path) {
    return is_black_box_file(path)
               ? escaped(path, 4096) +
                     ": invalid file (found a black box of axguardd, expected a trace). Read it "
                     "with axguard replay MACHINE FILE; with --frames-out LOG, replay writes its "
                     "frames as a candump log."
               : std::string();
}

/// @param end  of the trace
void print_inspect(std::FILE* out, const InspectReport& report, const TraceEnd& end) {
    const TraceSurvey& survey = report.survey;
    fmt::print(out, "{}: {} frames in {:.6f} s on {}, {} identifiers\n", report.file,
               survey.frame_count(), report.seconds, report.trace.device(), report.ids.size());
    if (end.lines_skipped > 0) {
        fmt::print(out, "{} lines skipped, the first: {}\n", end.lines_skipped, end.first_skipped);
    }
    if (report.trace.events() > 0) {
        fmt::print(out, "{} lines of other events, without a frame\n", report.trace.events());
    }
    print_ids(out, report.ids, survey.first_us());
    if (report.machine != nullptr) {
        print_axes(out, *report.machine, survey.snapshots());
        if (survey.snapshots().snapshots > 0) {
            print_limits(*report.machine, survey.limits(), out);
        }
        if (report.proposes_limits) {
            print_proposed_limits(*report.machine, survey.limits(),
                                  fmt::format("{}, {} samples", escaped(report.file, 4096),
                                              survey.snapshots().snapshots),
                                  out);
        }
    }
    if (!end.fault.empty()) {
        fmt::print(out, "\nTHE TRACE IS TRUNCATED: the rest is not in these figures\n  {}\n",
                   end.fault);
    }
}

int inspect(const InspectArguments& arguments) {
    TraceOptions options;
    options.lenient = arguments.lenient;
    options.device = arguments.device;
    Machine machine;
    const bool has_machine = !arguments.machine.empty();
    if (arguments.proposes_limits && !has_machine) {
        fmt::print(stderr, "--limits: missing option --machine. Add --machine FILE.\n");
        return kExitUsage;
    }
    if (has_machine) {
        MachineText source;
        const int code = load_without_meshes(
            {.file = arguments.machine, .mesh_root = {}, .files = arguments.json.files}, machine,
            source);
        if (code != kExitClean) {
            return code;
        }
    }
    std::string error = black_box_fault(arguments.trace);
    if (error.empty() && has_machine) {
        error = take_trace_shape(arguments.trace, options, machine).fault;
    }
    const std::unique_ptr<TraceReader> trace =
        error.empty() ? open_trace(arguments.trace, options, error) : nullptr;
    if (!trace) {
        fmt::print(stderr, "{}\n", error);
        const bool is_read = is_readable_input(arguments.trace);
        return !write_json(arguments.json, describe_unread(arguments.trace, error)) ? kExitInternal
               : is_read                                                            ? kExitCan
                                                                                    : kExitInput;
    }
    TraceSurvey survey(has_machine ? &machine : nullptr);
    CanFrame frame;
    while (trace->next(frame)) {
        survey.add(frame);
    }
    const TraceEnd end = end_of(*trace);
    if (!end.fault.empty()) {
        fmt::print(stderr, "{}\n", end.fault);
    }
    const std::map<IdKey, IdSurvey> ids = survey.ids();
    const double seconds = static_cast<double>(survey.last_us() - survey.first_us()) * 1e-6;
    const InspectReport report{
        arguments.trace,          *trace, survey, seconds, ids, has_machine ? &machine : nullptr,
        arguments.proposes_limits};
    print_inspect(arguments.json.words(), report, end);
    return !write_json(arguments.json, describe_inspect(report)) ? kExitInternal
           : end.fault.empty()                                   ? kExitClean
                                                                 : kExitCan;
}

}  // namespace

void add_inspect(CommandLine& line) {
    const auto arguments = std::make_shared<InspectArguments>();
    const Command command = line.add_command(
        "inspect", "Summarize a CAN trace: identifiers, rates, jitter, gaps, axes");
    command.set_group("Try programs");
    command.set_example("axguard inspect trace.log --machine machine.yaml");
    command
        .add_input("TRACE", arguments->trace,
                   "candump log or Vector ASC file, optionally compressed with gzip; - reads stdin")
        .required();
    command.add_input(
        "--machine", arguments->machine,
        "machine file: decode its axes and count the frames that the receiver rejects");
    command.add_flag("--limits", arguments->proposes_limits,
                     "with --machine: propose axis limits for the machine file");
    command.add_option("--device", arguments->device, "read only the frames of this interface");
    command.add_flag("--lenient", arguments->lenient, "skip and count invalid lines");
    add_json_option(command, arguments->json);
    command.set_action([arguments] { return inspect(*arguments); });
}

}  // namespace axg
