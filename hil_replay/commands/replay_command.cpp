// SPDX-License-Identifier: Apache-2.0
// axguard replay: a CAN trace against a machine, cycle by cycle, until the permit is withdrawn.
#include "hil_replay/commands/replay_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/admitted_plan_json.hpp"
#include "firmware_if/cli/command_files.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/cli/interrupt.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/progress.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "hil_replay/advice/advise_replay.hpp"
#include "hil_replay/commands/black_box_command.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/details_option.hpp"
#include "hil_replay/page/nearest_approach.hpp"
#include "hil_replay/page/pair_clearances.hpp"
#include "hil_replay/page/run_page.hpp"
#include "hil_replay/place/program_finder.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/replay_report.hpp"
#include "hil_replay/replay/replay_run.hpp"
#include "hil_replay/trace/added_session.hpp"
#include "hil_replay/trace/candump_log.hpp"
#include "hil_replay/trace/kept_input.hpp"
#include "hil_replay/trace/program_lines.hpp"
#include "hil_replay/trace/trace_period.hpp"
#include "hil_replay/trace/trace_reader.hpp"

namespace axg {
namespace {

std::int64_t steady_ns(void*) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// A file that was read and is no trace is an invalid trace; one that was not read is a wrong name.
int exit_code_of_unopened(const std::string& path) {
    return is_readable_input(path) ? kExitCan : kExitInput;
}

/// Outputs of each cycle in addition to the verdict.
struct Outputs {
    std::unique_ptr<ReplayCsv> csv;
    std::optional<PairClearances> clearances;  // for the table
    std::unique_ptr<CandumpWriter> frames;
    std::unique_ptr<PageRecorder> page;
    std::optional<ProgramFinder> program;
    NearestApproach* approach = nullptr;
};

Outputs open_outputs(const ReplayArguments& arguments, const LoadedMachine& loaded, Engine engine) {
    const Machine& machine = loaded.machine;
    Outputs outputs;
    if (!arguments.csv.empty()) {
        outputs.csv =
            std::make_unique<ReplayCsv>(machine, arguments.csv, arguments.mode == "stoppable");
        outputs.clearances.emplace(loaded, engine, arguments.within_mm);
    }
    if (!arguments.frames_out.empty()) {
        outputs.frames = std::make_unique<CandumpWriter>(arguments.frames_out);
    }
    if (!arguments.report.empty()) {
        outputs.page = std::make_unique<PageRecorder>(loaded, engine);
    }
    if (!arguments.gcode.program.empty()) {
        outputs.program.emplace(arguments.gcode, machine, program_settings(loaded.source, machine));
    }
    if (arguments.approach != nullptr) {
        outputs.approach = arguments.approach;
        outputs.approach->begin(loaded, engine, kPageWithinMm);
    }
    return outputs;
}

void note_cycle(Outputs& outputs, const ReplayCycle& cycle) {
    if (outputs.csv) {
        outputs.csv->on_cycle(cycle, outputs.clearances->at(cycle.snapshot).mm);
    }
    if (outputs.page) {
        PageCycle noted = page_cycle(cycle.sent_permit, cycle.result);
        noted.spent_ns = cycle.spent_ns;
        noted.clearance_level = cycle.clearance_level();
        outputs.page->note(cycle.snapshot, noted);
    }
    if (outputs.program) {
        outputs.program->add(cycle.snapshot);
    }
    if (outputs.approach != nullptr) {
        outputs.approach->note(cycle.snapshot);
    }
}

/// Writes the requested files. False: one was not written.
bool write_outputs(const ReplayArguments& arguments, const ReplayReport& report, Outputs& outputs) {
    const ReplayDocument document = describe_replay(report);
    bool written = write_json(arguments.json, document.text);
    if (outputs.csv && !outputs.csv->finish(stderr)) {
        written = false;
    }
    if (outputs.frames && !outputs.frames->finish()) {
        fmt::print(stderr, "{}\n", outputs.frames->error());
        written = false;
    }
    if (outputs.page) {
        const auto print = [&report](std::FILE* stream) {
            print_replay(report, Detail::full, stream);
        };
        const RunPage page{report.loaded,      outputs.page->finish(), &report.run.cycles(),
                           report.deadline_us, report.trace,           printed_text(print),
                           document.stops,     &report.lines};
        written = write_run_page(arguments.report, page, stderr) && written;
    }
    return written;
}

/// Prints how far an interrupted replay came.
void print_interrupted(const ReplayRun& run, std::int64_t last_us) {
    const std::string found =
        run.stop_count() == 0 ? "no stop" : fmt::format("{} stops", run.stop_count());
    fmt::print(stderr,
               "axguard: interrupted: {} until {:.6f} s ({} samples); the rest is not read\n",
               found, static_cast<double>(last_us) * 1e-6, run.cycles().count());
}

/// Feeds the trace, up to the first stop that ends it. Ctrl-C ends the program here.
TraceEnd feed(TraceReader& trace, ReplayRun& run, std::optional<AddedSession> added) {
    Interrupt interrupt;
    std::optional<Progress> progress(std::in_place);
    CanFrame frame;
    std::optional<std::int64_t> first_us;
    bool goes_on = true;
    while (goes_on && !interrupt.was_sent() && trace.next(frame)) {
        goes_on = run.on_frame(frame);
        const std::optional<CanFrame> session = added ? added->behind(frame) : std::nullopt;
        goes_on = goes_on && (!session || run.on_added(*session));
        first_us = first_us.value_or(frame.time_us);
        if (run.frame_count() % 4096 == 0 && progress->is_due()) {
            progress->show(static_cast<double>(frame.time_us - *first_us) * 1e-6, trace.share(),
                           fmt::format("{} frames", run.frame_count()));
        }
    }
    if (interrupt.was_sent()) {
        progress.reset();
        print_interrupted(run, frame.time_us);
        interrupt.end();
    }
    run.finish();
    TraceEnd end = end_of(trace);
    if (!goes_on) {
        end.fault.clear();  // a fault after the stop does not count
    }
    return end;
}

/// The exit code of a stop: silence in the trace withdraws the permit as a pair does; other faults
/// of the input, lost frames and another board's hashes are faults of the trace.
ExitCode exit_code_of(const StopEvent& stop) {
    switch (stop.cause) {
        case GuardFault::verdict:
        case GuardFault::silence:
            return kExitCollision;
        case GuardFault::engine:
        case GuardFault::gap:
            return kExitDeadline;
        case GuardFault::input:
            return stop.fault == ReceiverFault::stale ? kExitCollision : kExitCan;
        default:
            return kExitCan;
    }
}

int exit_code_of(const ReplayRun& run, bool is_realtime) {
    if (run.cycles().count() == 0) {
        return kExitCan;
    }
    const ExitCode late = is_realtime && run.overruns() != 0 ? kExitDeadline : kExitClean;
    for (const StopEvent& stop : run.stops()) {
        if (exit_code_of(stop) == kExitCan) {  // a fault of the trace precedes the other codes
            return kExitCan;
        }
    }
    if (run.stop_count() != 0) {
        return late != kExitClean ? late : exit_code_of(run.stops().front());
    }
    if (late != kExitClean) {
        return late;
    }
    return run.withheld().samples != 0 || run.permits() == 0 ? kExitCollision : kExitClean;
}

int exit_code_of(const ReplayReport& report, const Outputs& outputs) {
    if (!report.end.fault.empty()) {
        return kExitCan;
    }
    const int found = exit_code_of(report.run, report.is_realtime);
    const bool is_rejected = outputs.program && outputs.program->is_rejected();
    return found == kExitClean && is_rejected ? kExitInput : found;  // a stop comes first
}

/// A black box has its own mode, and is judged to its end.
int replay_dump(const ReplayArguments& arguments, LoadedMachine& loaded) {
    if (!arguments.csv.empty() || !arguments.report.empty() || arguments.keep_going ||
        !arguments.device.empty() || !arguments.plan_of.empty()) {
        fmt::print(stderr,
                   "{}: --csv, --report, --keep-going, --device and --plan-of need a trace. Write "
                   "the frames of the black box with --frames-out FILE and replay that file.\n",
                   escaped(arguments.trace, 4096));
        return kExitUsage;
    }
    std::optional<ProgramFinder> program;
    if (!arguments.gcode.program.empty()) {
        program.emplace(arguments.gcode, loaded.machine,
                        program_settings(loaded.source, loaded.machine));
        if (!program->open()) {
            return kExitInput;
        }
    }
    return replay_black_box({.file = arguments.trace,
                             .engine = arguments.engine,
                             .frames_out = arguments.frames_out,
                             .any_machine = arguments.lenient,
                             .program = program ? &*program : nullptr,
                             .detail = detail_of(arguments.has_details),
                             .json = arguments.json},
                            loaded);
}

ReplayOptions run_options_of(const ReplayArguments& arguments, const LoadedMachine& loaded,
                             CycleParts& parts, Outputs& outputs) {
    ReplayOptions options;
    options.parts = parts.chain();
    options.deadline_us =
        arguments.deadline_us != 0 ? arguments.deadline_us : loaded.machine.deadline_us;
    options.keep_going = arguments.keep_going;
    options.is_realtime = arguments.is_realtime;
    options.arm_from_us =
        arguments.arm_at_s < 0 ? INT64_MIN : std::llround(arguments.arm_at_s * 1e6);
    options.hashes = configuration_hashes(loaded.machine, loaded.meshes);
    options.clock.now_ns = &steady_ns;
    if (outputs.frames) {
        options.sent = [&outputs](const CanFrame& frame) { outputs.frames->write(frame); };
    }
    return options;
}

/// Matched with the program where one was passed, else from the table beside the trace.
ProgramLines lines_of(const ReplayArguments& arguments, Outputs& outputs) {
    ProgramLines lines;
    if (arguments.program_lines != nullptr) {
        lines = *arguments.program_lines;
    } else if (outputs.program) {
        lines = outputs.program->finish();
    } else if (const std::string note = load_program_lines(arguments.trace, arguments.lines, lines);
               !note.empty()) {
        fmt::print(stderr, "{}\n", note);
    }
    return lines;
}

/// Takes period and format from the trace.
/// @return  null with a message in TraceShape::fault
std::unique_ptr<TraceReader> open_shaped(const ReplayArguments& arguments, Machine& machine,
                                         TraceShape& shape) {
    const TraceOptions options{.lenient = arguments.lenient, .device = arguments.device};
    shape = take_trace_shape(arguments.trace, options, machine);
    return shape.fault.empty() ? open_trace(arguments.trace, options, shape.fault) : nullptr;
}

std::optional<AddedSession> added_session(const TraceShape& shape, const CanLayout& can) {
    return shape.lacks_session ? std::optional(AddedSession(can)) : std::nullopt;
}

/// Runs the first stop again with other settings; `report` explains it already.
void advise(const ReplayArguments& arguments, const TraceShape& shape, ReplayReport& report) {
    const std::span<const StopEvent> stops = report.run.stops();
    if (arguments.advice_s <= 0 || stops.empty() || !report.whys.contains(&stops.front())) {
        return;
    }
    GcodeArguments gcode = arguments.gcode;
    if (gcode.program.empty() && is_program_of(report.lines)) {
        gcode.program = report.lines.program;
    }
    report.whys.at(&stops.front()).advice =
        advise_replay({report.loaded,
                       report.engine.engine(),
                       report.containment_test,
                       report.trace,
                       {.lenient = arguments.lenient, .device = arguments.device},
                       shape.lacks_session,
                       report.run.limits(),
                       stops.front(),
                       gcode,
                       arguments.advice_s});
}

/// Takes the plan of a stored admission. False, with a message printed: it is none for this
/// machine.
bool take_plan(const ReplayArguments& arguments, LoadedMachine& loaded) {
    if (arguments.plan_of.empty()) {
        return true;
    }
    std::string fault;
    const auto admitted = read_admitted_plan(arguments.plan_of, loaded, fault);
    if (!admitted) {
        fmt::print(stderr, "{}\n", fault);
        return false;
    }
    loaded.machine.plan = admitted->plan;
    return true;
}

int replay(const ReplayArguments& arguments, const ReplayObserver& observer) {
    LoadedMachine loaded;
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    if (!take_plan(arguments, loaded)) {
        return kExitInput;
    }
    return is_black_box_file(arguments.trace) ? replay_dump(arguments, loaded)
                                              : replay_trace(arguments, loaded, observer);
}

/// How options about the program of the trace contradict each other; empty: they do not.
std::string program_conflict(const ReplayArguments& arguments, bool has_program, bool has_setting) {
    if (has_program && arguments.gcode.program.empty()) {
        return "--program: empty name. Pass a G-code program.";
    }
    if (has_program) {
        return arguments.lines.empty() ? "" : "--program replaces --lines. Leave one of them out.";
    }
    return has_setting ? "--start, --work-offset, --tool and other options about a program need "
                         "one. Pass it with --program."
                       : "";
}

void add_run_options(const Command& command, ReplayArguments& arguments) {
    command
        .add_option(
            "--engine", arguments.engine,
            "cpu, cuda (GPU) or auto (selected by measurement) [default: from the machine file]")
        .one_of({"cpu", "cuda", "auto"});
    command.add_option("--sms", arguments.multiprocessors,
                       "run on N GPU multiprocessors [default: 0 = all]");
    command
        .add_option("--mode", arguments.mode,
                    "stoppable: require a stop certificate for every sample; contact: check only "
                    "the sampled pose")
        .one_of({"contact", "stoppable"});
    command
        .add_option("--deadline-us", arguments.deadline_us,
                    "deadline of a cycle, us [default: deadline_us of the machine file]")
        .between(std::int64_t{1}, std::int64_t{10'000'000});
    command.add_flag(
        "--realtime", arguments.is_realtime,
        "withhold the permit of a late cycle, as axguardd does [default: count late cycles]");
    command.add_input("--plan-of", arguments.plan_of,
                      "prove with the plan of this verdict, which axguardd admit or run stored on "
                      "the guard's computer [default: plan of the machine file]");
    command
        .add_option("--arm-at", arguments.arm_at_s,
                    "arm at this time of the trace, s [default: as soon as the guard is ready]")
        .between(0.0, 1e10);
    command
        .add_option("--advice-s", arguments.advice_s,
                    "seconds before the first stop to run again with other values of the machine "
                    "file; prints those that stop nearer; 0: none")
        .between(0.0, 1e6)
        .shows_default();
}

}  // namespace

int replay_trace(const ReplayArguments& arguments, LoadedMachine& loaded,
                 const ReplayObserver& observer) {
    if (arguments.is_realtime && arguments.deadline_us != 0) {  // the guard judges by it
        loaded.machine.deadline_us = static_cast<std::uint32_t>(arguments.deadline_us);
    }
    TraceShape shape;
    const std::unique_ptr<TraceReader> trace = open_shaped(arguments, loaded.machine, shape);
    if (!trace) {
        fmt::print(stderr, "{}\n", shape.fault);
        return write_json(arguments.json, describe_unread(arguments.trace, shape.fault))
                   ? exit_code_of_unopened(arguments.trace)
                   : static_cast<int>(kExitInternal);
    }
    const bool is_stoppable = arguments.mode == "stoppable";
    GuardParts parts(loaded, is_stoppable);
    if (!parts.fault().empty()) {
        fmt::print(stderr, "{}\n", parts.fault());
        return kExitUnfit;
    }
    CpuEngine& engine = *parts.engine;
    Outputs outputs = open_outputs(arguments, loaded, engine.engine());
    if (outputs.program && !outputs.program->open()) {
        return kExitInput;
    }
    const ReplayOptions run_options = run_options_of(arguments, loaded, parts.cycle, outputs);
    const auto observe = [&outputs](const ReplayCycle& cycle) { note_cycle(outputs, cycle); };
    CycleDemand demand = cycle_demand(loaded.machine, is_stoppable);
    demand.times = time_limits(loaded.machine.can, run_options.deadline_us);
    ChosenEngine chosen =
        choose_and_report(loaded, engine, arguments.engine, demand, arguments.multiprocessors);
    if (chosen.refusal != EngineRefusal::none) {
        return exit_code_of(chosen.refusal);
    }
    ReplayRun run(loaded.machine, chosen.engine(engine), *parts.containment_test, run_options,
                  observe);
    const TraceEnd end = feed(*trace, run, added_session(shape, loaded.machine.can));
    if (!end.fault.empty()) {
        fmt::print(stderr, "{}\n", end.fault);
    }
    ProgramLines lines = lines_of(arguments, outputs);
    const bool gpu_failed = report_if_gave_up(chosen);
    ReplayReport report{loaded,
                        engine,
                        *parts.containment_test,
                        run,
                        run_options.deadline_us,
                        arguments.title.empty() ? arguments.trace : arguments.title,
                        chosen.gpu_name(),
                        arguments.plan_of,
                        arguments.is_realtime,
                        end,
                        std::move(lines),
                        shape.period};
    explain_stops(report);
    advise(arguments, shape, report);
    if (arguments.title.empty()) {
        print_replay(report, detail_of(arguments.has_details), arguments.json.words());
    }
    if (outputs.approach != nullptr) {
        outputs.approach->finish();
    }
    if (observer) {
        observer(report);
    }
    if (!write_outputs(arguments, report, outputs)) {
        return kExitInternal;
    }
    return gpu_failed ? static_cast<int>(kExitGpu) : exit_code_of(report, outputs);
}

void add_replay(CommandLine& line, const ReplayObserver& observer) {
    auto arguments = std::make_shared<ReplayArguments>();
    const Command command =
        line.add_command("replay", "Replay a CAN trace through the guard and report every stop");
    command.set_group("Try programs");
    command.set_example("axguard replay machine.yaml trace.log --csv cycles.csv");
    add_machine_options(command, arguments->machine);
    command
        .add_input("TRACE", arguments->trace,
                   "candump log, Vector ASC file or black box of axguardd; - reads stdin")
        .required();
    add_run_options(command, *arguments);
    command.add_flag("--keep-going", arguments->keep_going, "continue after a stop");
    command.add_output("--csv", arguments->csv,
                       "write one CSV line per sample: axes, permit, clearances");
    command
        .add_option("--within", arguments->within_mm,
                    "with --csv: largest clearance to measure, mm")
        .between(1e-6, kMarginMmMax)
        .shows_default();
    command.add_output(
        "--frames-out", arguments->frames_out,
        "write the guard's frames as a candump log; for a black box: all its frames");
    command.add_output("--report", arguments->report,
                       "write one HTML report: the machine in motion, clearances, stops");
    command.add_input("--lines", arguments->lines,
                      "program lines of the trace [default: TRACE.lines, written by simulate]");
    const Option program = command.add_input(
        "--program", arguments->gcode.program,
        "G-code program that the trace ran: finds the line of each stop by matching the path");
    const std::vector<Option> settings = add_gcode_settings(command, arguments->gcode);
    command.add_option("--device", arguments->device, "read only the frames of this interface");
    command.add_flag("--lenient", arguments->lenient, "skip and count invalid lines");
    add_details_option(command, arguments->has_details);
    add_json_option(command, arguments->json);
    command.set_action([arguments, files = command.files(), program, settings, observer] {
        const bool has_setting = std::any_of(settings.begin(), settings.end(),
                                             [](const Option& one) { return one.is_given(); });
        const std::string conflict = program_conflict(*arguments, program.is_given(), has_setting);
        if (!conflict.empty()) {
            fmt::print(stderr, "axguard: {}\n", conflict);
            return static_cast<int>(kExitUsage);
        }
        const std::string lines = program_lines_name(arguments->trace);  // read without an option
        return are_apart(*files, {lines}, stderr) ? replay(*arguments, observer)
                                                  : static_cast<int>(kExitUsage);
    });
}

}  // namespace axg
