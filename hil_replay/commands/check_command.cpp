// SPDX-License-Identifier: Apache-2.0
// axguard check: prints all values in force of a machine file, so that a person can see a plausible
// but wrong one.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <vector>

#include "config/init/tool_table.hpp"
#include "config/machine/effective_text.hpp"
#include "config/machine/effective_yaml.hpp"
#include "config/machine/program_settings.hpp"
#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/small_file.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/check/check_json.hpp"
#include "hil_replay/check/check_report.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/page/jog_page.hpp"
#include "hil_replay/plan/plan_report.hpp"

namespace axg {
namespace {

struct CheckOptions {
    MachineOptions machine;
    std::string engine;
    std::uint32_t multiprocessors = 0;
    bool has_plan = false, is_effective = false;
    std::string report;   // the page's file; empty: none
    std::string plan_of;  // a stored admission; empty: none
    std::string tool_table;
    ModelChoiceOptions plan;
    JsonOutput json;
};

/// Prints the effective YAML only, so that stdout can be a file that axguard reads back.
int print_effective(const LoadedMachine& loaded) {
    fmt::print(
        "# The effective configuration of {}: every key, with its value in force.\n"
        "# configuration {}\n{}",
        escaped(loaded.source.file, 4096), configuration_hash(loaded.machine, loaded.meshes),
        effective_yaml(loaded.source, loaded.machine));
    return kExitClean;
}

/// Writes a page of the machine with each axis moved a little, to compare with the real machine.
int write_report(const CheckOptions& options, const LoadedMachine& loaded) {
    std::optional<CpuEngine> engine = make_engine(loaded);
    if (!engine) {
        fmt::print(stderr, "{}\n", kNoLaneSet);
        return kExitUnfit;
    }
    const std::vector<AxisJog> jogs = plan_jogs(loaded.machine);
    PageRecorder page(loaded, engine->engine());
    record_jogs(loaded.machine, jogs, page);
    std::string words =
        "Each axis makes a small motion and returns, from all axes at 0 or the nearest position.\n";
    for (const AxisJog& jog : jogs) {
        const bool is_rotary = loaded.machine.axes[jog.axis].kind == AxisKind::rotary;
        words += fmt::format("{:g} s to {:g} s: {:+.6g} {}; {}\n", jog.begin_s, jog.end_s,
                             jog.distance * (is_rotary ? 180 / kPi : 1), is_rotary ? "deg" : "mm",
                             describe_motion(loaded.machine, jog.axis));
    }
    const RunPage run{.loaded = loaded,
                      .samples = page.finish(),
                      .cycles = nullptr,
                      .deadline_us = loaded.machine.deadline_us,
                      .title = "axguard check",
                      .words = words,
                      .stops = "[]",
                      .guessed_axes = guessed_joints(loaded)};
    return write_run_page(options.report, run, stderr) ? kExitClean : kExitInternal;
}

struct TableReport {
    std::string words;                     // what was compared, and in which unit; empty: nothing
    std::vector<std::string> differences;  // a line each
};

/// What differs from LinuxCNC's tool table, read in the unit in which its programs start; false
/// after a message.
bool compare_tools(const std::string& file, const LoadedMachine& loaded, TableReport& out) {
    std::string text;
    const std::string shown = escaped(file, 4096);
    if (const SmallFileFault fault = read_small_file(file, kToolTableBytesMax, text);
        !fault.got.empty() || !fault.wanted.empty()) {
        fmt::print(stderr, "{}: {}\n", shown, fault_text("invalid file", fault.got, fault.wanted));
        return false;
    }
    const std::optional<bool> is_inch =
        program_settings(loaded.source, loaded.machine).starts_in_inch;
    const ToolTable table = read_tool_table(text, shown, is_inch.value_or(false) ? 25.4 : 1);
    out.differences = tool_differences(table, shown, loaded.machine);
    out.words = fmt::format("{}: tools read: {}, lengths in {}{}", shown, table.tools.size(),
                            is_inch.value_or(false) ? "inch" : "mm",
                            is_inch ? ", as program.start_unit of the machine file"
                                    : ": program.start_unit is not stated");
    if (!out.differences.empty() && !is_inch) {
        out.differences.push_back(shown +
                                  ": read in mm. If the control counts in inch, state program: "
                                  "{start_unit: inch}.");
    }
    return true;
}

int check(const CheckOptions& options) {
    LoadedMachine loaded;
    if (const int code = load(options.machine, loaded); code != kExitClean) {
        return code;
    }
    TableReport table;
    if (!options.tool_table.empty() && !compare_tools(options.tool_table, loaded, table)) {
        return kExitInput;
    }
    if (options.is_effective) {
        return print_effective(loaded);
    }
    if (!options.report.empty()) {
        const int code = write_report(options, loaded);
        if (code != kExitClean) {
            return code;
        }
    }
    CheckReport report{.loaded = loaded,
                       .words = options.json.words(),
                       .warnings = {},
                       .engine = engine_choice(options.engine, loaded.machine),
                       .multiprocessors = options.multiprocessors};
    const std::string hash = configuration_hash(loaded.machine, loaded.meshes);
    const ConfigurationHashes hashes = configuration_hashes(loaded.machine, loaded.meshes);
    fmt::print(report.words, "{}: {}\nconfiguration {}\n", escaped(options.machine.file, 4096),
               escaped(loaded.machine.name), hash);
    if (is_compiled_name(options.machine.file)) {
        fmt::print(report.words, "compiled from {}\n", escaped(loaded.source.file, 4096));
    }
    fmt::print(report.words,
               "for the board: model {:08x}, kinematics {:08x}, tools {:08x}, limits "
               "{:08x}\n",
               hashes.of[0], hashes.of[1], hashes.of[2], hashes.of[3]);
    report_axes(report);
    report_motion(report);
    report_frames(report);
    report_bodies(report);
    report_tools(report);
    if (!table.words.empty()) {
        fmt::print(report.words, "  {}\n", table.words);
    }
    report.warnings.insert(report.warnings.end(), table.differences.begin(),
                           table.differences.end());
    report_pairs(report);
    report_pose_errors(report);
    report_guard(report);
    report_engine(report);
    if (!options.plan_of.empty()) {
        report_admitted(report, options.plan_of);
    }
    report_guesses(
        report, is_compiled_name(options.machine.file) ? loaded.source.file : options.machine.file);
    if (options.has_plan && report.exit_code == kExitClean) {
        report_plan(report, options.plan);
    }
    fmt::print(report.words, "\nto review: {}\n", report.warnings.size());
    for (const std::string& warning : report.warnings) {
        fmt::print(report.words, "  {}\n", warning);
    }
    const CheckedFile checked{options.machine.file, hash, hashes,
                              is_compiled_name(options.machine.file)};
    return write_json(options.json, describe_check(checked, report)) ? report.exit_code
                                                                     : kExitInternal;
}

}  // namespace

void add_check(CommandLine& line) {
    auto options = std::make_shared<CheckOptions>();
    const Command command =
        line.add_command("check", "Validate a machine file and its meshes and print a summary");
    command.set_group("Set up a machine");
    command.set_example("axguard check config/machines/paper-trunnion.yaml");
    add_machine_options(command, options->machine);
    options->machine.lists_doubts = true;
    command
        .add_option("--engine", options->engine,
                    "check whether this engine can run on this host: cpu, cuda (GPU) or auto "
                    "[default: from the machine file]")
        .one_of({"cpu", "cuda", "auto"});
    command.add_option("--sms", options->multiprocessors,
                       "run on N GPU multiprocessors [default: 0 = all]");
    command.add_flag("--plan", options->has_plan,
                     "measure coarser models and select the coarsest that loses no result");
    command
        .add_option("--positions", options->plan.positions,
                    "with --plan: number of positions, spread over the travel")
        .between(2U, 10'000'000U)
        .shows_default();
    command
        .add_option("--passes", options->plan.passes,
                    "with --plan: report the best time of N passes")
        .between(1U, 1000U)
        .shows_default();
    command.add_input("--trace", options->plan.trace,
                      "with --plan: include the samples of this trace of the machine");
    command.add_output_folder(
        "-o,--output", options->plan.out,
        "with --plan: folder for plan.csv, lost.csv, conditions.csv, plan.svg and plan.png");
    command.add_input("--plan-of", options->plan_of,
                      "compare the plan of the machine file with that of this verdict, which "
                      "axguardd admit or run stored on the guard's computer");
    command.add_input("--tool-table", options->tool_table,
                      "LinuxCNC tool table, in the machine file's program.start_unit [mm]: list "
                      "its differences from the machine's tools");
    command.add_flag("--effective", options->is_effective,
                     "print only the effective machine file: every key with its value");
    command.add_output("--report", options->report,
                       "write an HTML report: the machine and a small motion of each axis");
    add_json_option(command, options->json);
    command.set_action([options] { return check(*options); });
}

}  // namespace axg
