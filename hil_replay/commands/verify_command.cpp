// SPDX-License-Identifier: Apache-2.0
// axguard verify: programs simulated and replayed in one, for the question whether they are clear.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "config/machine/effective_text.hpp"
#include "firmware_if/cli/command_files.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/temporary_file.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/replay_command.hpp"
#include "hil_replay/commands/simulate_command.hpp"
#include "hil_replay/commands/verify_report.hpp"
#include "hil_replay/page/nearest_approach.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/replay_report.hpp"

namespace axg {
namespace {

struct VerifyArguments {
    MachineOptions machine;
    GcodeArguments gcode;  // program: the one at hand
    std::vector<std::string> programs;
    std::string overrides = "100", engine, report;
    JsonOutput json;
};

constexpr double kAbove = 1 + 1e-9;  // of a feed: roundings of the override

VerifyEvent event_at(const ProgramLines& lines, const AxisSnapshot& snapshot, std::string what) {
    VerifyEvent event{.what = std::move(what), .tool = snapshot.tool};
    event.time_s = static_cast<double>(snapshot.arrived_us - kTraceStartUs) * 1e-6;
    if (const ProgramStep* const step = step_at(lines, snapshot.arrived_us)) {
        event.line = step->line;
        event.block = step->block;
    }
    return event;
}

void take_results(const ReplayReport& report, const NearestApproach& approach, VerifyRun& run) {
    const Machine& machine = report.loaded.machine;
    run.permits = report.run.permits();
    run.stop_count = report.run.stop_count();
    run.is_unproven = report.run.withheld().samples != 0 || report.run.permits() == 0;
    for (const NearPair& contact : approach.contacts()) {
        run.contacts.push_back(
            event_at(report.lines, contact.snapshot, pair_name(machine, contact.pair)));
    }
    for (const StopEvent& stop : report.run.stops()) {
        std::string what = reason_text(stop);
        what += stop.pair == kNoIndex ? "" : ", " + pair_name(machine, stop.pair);
        run.stops.push_back(event_at(report.lines, stop.snapshot, std::move(what)));
    }
    if (report.run.withheld().samples != 0) {
        const StopEvent& withheld = report.run.withheld();
        std::string what = std::string("no permit: ") + reason_text(withheld);
        what += withheld.pair == kNoIndex ? "" : ", " + pair_name(machine, withheld.pair);
        run.stops.push_back(event_at(report.lines, withheld.snapshot, std::move(what)));
    }
    for (const NearPair& nearest : approach.of_tools()) {
        const bool is_near = nearest.pair != kNoIndex;
        VerifyEvent event = event_at(report.lines, nearest.snapshot,
                                     is_near ? pair_name(machine, nearest.pair) : "");
        event.clearance_mm = is_near ? nearest.clearance_mm : HUGE_VAL;
        run.nearest.push_back(std::move(event));
    }
}

/// A file for a trace that nobody keeps.
std::optional<TemporaryFile> temporary_trace() {
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    TemporaryFile file;
    const int opened = error ? -1 : file.create(folder.string());
    if (opened < 0) {
        fmt::print(stderr, "axguard: {}: no trace can be written here. Set TMPDIR.\n",
                   folder.string());
        return std::nullopt;
    }
    close(opened);
    return file;
}

class Verification {
  public:
    Verification(const VerifyArguments& arguments, LoadedMachine& loaded, VerifyReport& report)
        : arguments_(arguments), loaded_(loaded), report_(report) {}

    /// Reads, simulates and replays one program, at every override.
    void verify(const std::string& file) {
        VerifiedProgram program{.file = file};
        GcodeArguments gcode = arguments_.gcode;
        gcode.program = file;
        GcodeOptions options;
        if (!make_gcode_options(gcode, loaded_.machine,
                                program_settings(loaded_.source, loaded_.machine), options)) {
            program.exit_code = kExitUsage;
        } else if (GcodeResult reading; !is_start_inside(loaded_.machine, options.start) ||
                                        !read_program(gcode, loaded_.machine, options, reading) ||
                                        !reading.faults.empty()) {
            program.exit_code = kExitInput;
        } else {
            program.read_as = read_as_text(reading.read_as);
            for (const int percent : report_.overrides) {
                program.runs.push_back(run_at(percent, file, reading));
                program.exit_code = std::max(program.exit_code, program.runs.back().exit_code);
            }
        }
        report_.programs.push_back(std::move(program));
    }

  private:
    VerifyRun run_at(int percent, const std::string& file, const GcodeResult& reading) {
        VerifyRun run{.override_percent = percent};
        const std::optional<TemporaryFile> trace = temporary_trace();
        if (!trace) {
            run.exit_code = kExitInternal;
            return run;
        }
        Program program = reading.program;
        scale_feeds(program, percent);
        note_cut_feeds(program);
        SimulationOptions options;
        options.sample_us = loaded_.machine.can.sample_us;
        options.samples_max = arguments_.gcode.samples_max;
        options.motion.cap_rapids = false;
        SimulationSummary summary = simulate_with_progress(
            loaded_.machine, program, reading.line_count, options, trace->path());
        run.program_s = summary.program_s;
        run.path_mm = summary.path_mm;
        run.samples = summary.samples;
        if (!summary.error.empty()) {
            fmt::print(stderr, "{}:{}\n", file, summary.error);
            run.exit_code = summary.exit_code;
            return run;
        }
        summary.lines.program = file;
        summary.lines.read_as = read_as_text(reading.read_as);
        add_blocks(summary.lines, reading.text);
        replay(trace->path(), file, summary.lines, run);
        return run;
    }

    /// A feed above the cap of simulated feeds is not what the control would drive.
    void note_cut_feeds(const Program& program) {
        const double cap_mm_min = 60 * loaded_.machine.program_speed_mm_s;
        const bool is_cut =
            std::any_of(program.moves.begin(), program.moves.end(), [cap_mm_min](const Move& move) {
                return move.feed_kind == FeedKind::per_minute && move.feed > cap_mm_min * kAbove;
            });
        report_.cut_mm_min = is_cut ? cap_mm_min : report_.cut_mm_min;
    }

    void replay(const std::string& trace, const std::string& file, const ProgramLines& lines,
                VerifyRun& run) {
        NearestApproach approach;
        ReplayArguments replay;
        replay.trace = trace;
        replay.title = file;
        replay.engine = arguments_.engine;
        replay.keep_going = true;
        replay.advice_s = 0;
        replay.program_lines = &lines;
        replay.approach = &approach;
        replay.report = has_page_of_fault_ ? "" : arguments_.report;
        run.exit_code = replay_trace(replay, loaded_, [&](const ReplayReport& report) {
            take_results(report, approach, run);
        });
        has_page_of_fault_ = has_page_of_fault_ || run.exit_code != kExitClean;
    }

    const VerifyArguments& arguments_;
    LoadedMachine& loaded_;
    VerifyReport& report_;
    bool has_page_of_fault_ = false;  // the page shows the first run that is not clear
};

/// False: a word of the command line is wrong; prints why.
bool is_usable(const VerifyArguments& arguments, const CommandFiles& files,
               const VerifyReport& report) {
    if (report.overrides.empty()) {
        fmt::print(stderr,
                   "--override: invalid value (found \"{}\", expected {} to {} or a range such as "
                   "30..150).\n",
                   arguments.overrides, kOverrideLeast, kOverrideMost);
        return false;
    }
    if (!arguments.report.empty() && arguments.programs.size() > 1) {
        fmt::print(stderr, "--report: one page for {} programs. Pass one program.\n",
                   arguments.programs.size());
        return false;
    }
    for (const std::string& program : arguments.programs) {
        const std::string fault =
            misplaced_input({{"MACHINE", &arguments.machine.file}, {"PROGRAM", &program}});
        if (!fault.empty()) {
            fmt::print(stderr, "{}\n", fault);
            return false;
        }
    }
    return are_apart(files, arguments.programs, stderr);
}

int run_verify(const VerifyArguments& arguments, const CommandFiles& files) {
    VerifyReport report{.version = AXG_VERSION, .overrides = read_overrides(arguments.overrides)};
    if (!is_usable(arguments, files, report)) {
        return kExitUsage;
    }
    LoadedMachine loaded;
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    report.machine = loaded.machine.name;
    report.not_obeyed = obeyed_by_refusal(loaded.machine);
    std::FILE* const words = arguments.json.words();
    const bool is_table = arguments.programs.size() > 1;
    if (is_table) {
        print_table_head(words);
    }
    Verification verification(arguments, loaded, report);
    for (const std::string& program : arguments.programs) {
        verification.verify(program);
        if (is_table) {
            print_table_row(report.programs.back(), words);
        }
    }
    if (is_table) {
        print_table_end(report, words);
    } else {
        print_program(report, report.programs.front(), words);
    }
    return write_json(arguments.json, describe_verify(report)) ? report.exit_code()
                                                               : static_cast<int>(kExitInternal);
}

}  // namespace

void add_verify(CommandLine& line) {
    const auto arguments = std::make_shared<VerifyArguments>();
    const Command command =
        line.add_command("verify", "Simulate and replay programs: is each clear, and how near?");
    command.set_group("Try programs");
    command.set_example(
        "axguard verify config/machines/paper-trunnion.yaml "
        "hil_replay/programs/paper-trunnion-clean.ngc --override 30..150");
    add_machine_options(command, arguments->machine);
    command
        .add_option("PROGRAM", arguments->programs,
                    "G-code programs in LinuxCNC's dialect, one or several")
        .required();
    command
        .add_option("--override", arguments->overrides,
                    "feed override, 30 to 150 %; a range such as 30..150 proves both ends and 100")
        .shows_default();
    command
        .add_option(
            "--engine", arguments->engine,
            "cpu, cuda (GPU) or auto (selected by measurement) [default: from the machine file]")
        .one_of({"cpu", "cuda", "auto"});
    command.add_output(
        "--report", arguments->report,
        "write one HTML report of the first run that is not clear, else of the last");
    add_gcode_settings(command, arguments->gcode);
    add_samples_limit(command, arguments->gcode);
    add_json_option(command, arguments->json);
    command.set_action(
        [arguments, files = command.files()] { return run_verify(*arguments, *files); });
}

}  // namespace axg
