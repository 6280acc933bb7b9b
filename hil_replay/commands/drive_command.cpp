// SPDX-License-Identifier: Apache-2.0
// axguard drive: a program on a simulated motion board, with the guard on the other end of the
// wire.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/cli/interrupt.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/progress.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/explain/format_escapes.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "hil_replay/advice/advise_drive.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/details_option.hpp"
#include "hil_replay/commands/drive_command.hpp"
#include "hil_replay/drive/drive_report.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"
#include "hil_replay/motion/least_time.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "hil_replay/page/run_page.hpp"
#include "hil_replay/replay/read_faults.hpp"

namespace axg {
namespace {

/// One line a sample: true axes, the board's action, and the guard's permit and reason.
class DriveCsv {
  public:
    explicit DriveCsv(const Machine& machine) : machine_(machine), text_(csv_head(machine)) {
        has_clearance_levels_ = has_clearance_levels(machine);
        text_ += has_clearance_levels_ ? ",permit,reason,level\n" : ",permit,reason\n";
    }

    void add(const MotionBoard& board, const DriveGuard& guard) {
        text_ += fmt::format("{},{}", board.samples() - 1, to_text(board.state()));
        std::array<double, kAxesMax> positions{};
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            positions[i] = board.axes()[i].position;
        }
        text_ += csv_axes(machine_, positions);
        text_ += fmt::format(",{},{}", guard.has_permit() ? 1 : 0, to_text(guard.result().reason));
        text_ += has_clearance_levels_
                     ? fmt::format(",{}\n", to_text(guard.result().advisories.clearance_level))
                     : "\n";
    }
    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    const Machine& machine_;
    std::string text_;
    bool has_clearance_levels_;
};

/// Options of the run from the command line. An exit code, after a message, if they are invalid.
int make_options(const DriveArguments& arguments, const LoadedMachine& loaded,
                 DriveOptions& options, GcodeOptions& gcode) {
    const Machine& machine = loaded.machine;
    options.board = promised_board(machine, arguments.seed);
    options.board.tick_us = kMotionStepUs;
    options.board.hashes = configuration_hashes(machine, loaded.meshes);
    options.response_us = machine.deadline_us;
    options.time_us_max =
        static_cast<std::int64_t>(arguments.gcode.samples_max) * machine.can.sample_us;
    if (!make_gcode_options(arguments.gcode, machine, program_settings(loaded.source, machine),
                            gcode)) {
        return kExitUsage;
    }
    if (!is_start_inside(machine, gcode.start)) {
        return kExitInput;
    }
    const std::string bad_faults = read_faults(arguments.faults, options.faults);
    if (!bad_faults.empty()) {
        fmt::print(stderr, "--faults: {}\n", bad_faults);
        return kExitUsage;
    }
    if (arguments.mode == "contact" && arguments.obeys_cap) {
        fmt::print(stderr,
                   "--obey-cap: conflicts with --mode contact, which has no speed cap. Leave one "
                   "of them out.\n");
        return kExitUsage;
    }
    if (arguments.jogs_out && !machine.guard.jog.is_promised) {
        fmt::print(stderr,
                   "--jog-out: {} has no guard.single_jog. State it, or leave the option out.\n",
                   machine.name);
        return kExitUsage;
    }
    return kExitClean;
}

/// Drives, with a line on the terminal and one in the table for each sample, if requested.
/// @param whole_s  duration of the motion without a stop; 0: no estimate
DriveResult run_observed(const DriveArguments& arguments, const Machine& machine, GuardChain& chain,
                         const AxisPositions& start, CommandedMotion motion, double whole_s,
                         const DriveOptions& options, DriveCsv& csv, PageRecorder* page,
                         PathJudge& judge, ProgramLines& lines) {
    Interrupt interrupt;
    std::optional<Progress> progress(std::in_place);
    DriveObservers observers;
    std::int64_t noted_us = INT64_MIN;
    observers.watch = [&](std::int64_t time_us, std::span<const AxisMotion> axes) {
        const std::uint16_t tool = chain.snapshot().tool;
        judge.look(time_us, axes, tool == 0 ? machine.first_tool : tool);
    };
    observers.each = [&](const MotionBoard& board, const DriveGuard& guard) {
        const double done_s = static_cast<double>(board.next_latch_us() - kBoardStartUs) * 1e-6;
        if (interrupt.was_sent()) {
            progress.reset();
            fmt::print(stderr, "axguard: interrupted: {} until {:.3f} s of the drive\n",
                       has_reason(guard.stop()) ? "a stop" : "no stop", done_s);
            interrupt.end();
        }
        if (progress->is_due()) {
            progress->show(done_s, whole_s > 0 ? done_s / whole_s : 0, to_text(board.state()));
        }
        if (!arguments.csv.empty()) {
            csv.add(board, guard);
        }
        add_program_step(lines, board.next_latch_us() - machine.can.sample_us, board.line());
        const AxisSnapshot& snapshot = chain.snapshot();
        if (page != nullptr && snapshot.axis_count != 0 && snapshot.latched_us != noted_us) {
            noted_us = snapshot.latched_us;  // a lost sample leaves the snapshot as it was
            page->note(snapshot, page_cycle(guard.has_permit(), guard.result()));
        }
        return true;
    };
    return drive(machine, chain, {start.data(), machine.axes.size()}, std::move(motion), options,
                 observers);
}

}  // namespace

int exit_code_of(const DriveArguments& arguments, const Machine& machine, const DriveResult& result,
                 bool has_contact) {
    if (result.encoded.status != EncodeStatus::ok) {
        const std::uint32_t axis = result.encoded.axis;
        fmt::print(stderr, "{}: {}{}: outside the range of the machine file's frames\n",
                   arguments.gcode.program, axis == kNoIndex ? "" : machine.axes[axis].name + ": ",
                   to_text(result.encoded.status));
        return kExitInput;
    }
    if (exit_code_of(result.guard_stop.cause) == kExitCan &&
        result.guard_stop.cause != GuardFault::none) {
        return kExitCan;
    }
    return result.state == BoardState::finished && !has_contact ? kExitClean : kExitCollision;
}

bool write_page(const DriveArguments& arguments, const LoadedMachine& loaded,
                const DriveReport& report, const PageSamples& samples) {
    const RunPage page{
        loaded,
        samples,
        nullptr,
        loaded.machine.deadline_us,
        arguments.gcode.program,
        printed_text([&report](std::FILE* stream) { print_drive(report, Detail::full, stream); }),
        describe_stops(report),
        &report.lines};
    return write_run_page(arguments.report, page, stderr);
}

void look_for_ways_out(const DriveArguments& arguments, const LoadedMachine& loaded,
                       const ContainmentTest& containment_test, const DriveOptions& options,
                       DriveReport& report) {
    const AxisSnapshot rest = snapshot_at_rest(loaded.machine, report.result);
    report.escapes = find_escapes(loaded, report.engine, containment_test, rest);
    const DriveStop& stop = report.result.guard_stop;
    report.why = why_of({.loaded = loaded, .engine = report.engine},
                        {stop.reason, stop.pair, stop.snapshot, stop.unproven});
    if (arguments.jogs_out) {
        report.jogs = jog_out(loaded, report.engine, containment_test, rest, options);
    }
}

int read_inputs(const DriveArguments& arguments, LoadedMachine& loaded, DriveOptions& options,
                GcodeOptions& gcode, GcodeResult& reading) {
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    const int bad_options = make_options(arguments, loaded, options, gcode);
    if (bad_options != kExitClean) {
        return bad_options;
    }
    if (!read_program(arguments.gcode, loaded.machine, gcode, reading)) {
        return kExitInput;
    }
    if (!reading.faults.empty()) {
        fmt::print(stderr, "{}: program rejected. Correct it, or see docs/reference/gcode.md.\n",
                   arguments.gcode.program);
        return kExitInput;
    }
    return kExitClean;
}

std::string csv_head(const Machine& machine) {
    std::string text = "sample,board";
    for (const Axis& axis : machine.axes) {
        text += fmt::format(",{}_{}", axis.name, axis.kind == AxisKind::rotary ? "deg" : "mm");
    }
    return text;
}

std::string csv_axes(const Machine& machine, std::span<const double> positions) {
    std::string text;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        text += fmt::format(",{:.6f}", in_file_units(machine.axes[i], positions[i]));
    }
    return text;
}

namespace {

/// Text, CSV, page and JSON. Returns kExitInternal if a file was not written, else the run's code.
int write_results(const DriveArguments& arguments, const LoadedMachine& loaded,
                  const DriveReport& report, const DriveCsv& csv, PageRecorder* page,
                  bool gpu_failed) {
    const int exit_code = gpu_failed ? kExitGpu
                                     : exit_code_of(arguments, loaded.machine, report.result,
                                                    report.contact.has_value());
    if (report.result.encoded.status == EncodeStatus::ok) {
        print_drive(report, detail_of(arguments.has_details), arguments.json.words());
    }
    bool is_written = arguments.csv.empty() || write_whole_file(arguments.csv, csv.text(), stderr);
    is_written =
        (page == nullptr || write_page(arguments, loaded, report, page->finish())) && is_written;
    return write_json(arguments.json, describe_drive(report)) && is_written ? exit_code
                                                                            : kExitInternal;
}

/// Drives a program that was stopped again with other settings; the report explains the stop.
void advise(const DriveArguments& arguments, const LoadedMachine& loaded,
            const ContainmentTest& containment_test, const Program& program,
            const AxisPositions& start, DriveReport& report) {
    const DriveStop& stop = report.result.guard_stop;
    const std::int64_t stopped_us = stop.snapshot.latched_us - kBoardStartUs;
    const bool is_plain = arguments.faults.empty() && !arguments.obeys_cap;
    if (!report.why || !is_plain || !is_advisable(stop.reason, stop.unproven) ||
        static_cast<double>(stopped_us) > arguments.advice_s * 1e6) {
        return;
    }
    const RunEnd first{.is_stopped = true,
                       .is_complete = true,
                       .pair = stop.pair,
                       .left_mm = report.why->available_mm,
                       .snapshot = stop.snapshot};
    const BoardRun run{report.engine, containment_test, program, start, arguments.seed};
    advise_drive({loaded, run, first, stop.unproven}, report.why->advice.emplace());
}

int run_drive(const DriveArguments& arguments) {
    LoadedMachine loaded;
    DriveOptions options;
    GcodeOptions gcode;
    GcodeResult reading;
    if (const int refused = read_inputs(arguments, loaded, options, gcode, reading);
        refused != kExitClean) {
        return refused;
    }
    const Machine& machine = loaded.machine;
    const bool is_stoppable = arguments.mode == "stoppable";
    GuardParts made(loaded, is_stoppable, machine.guard.speed_cap || arguments.obeys_cap);
    if (!made.fault().empty()) {
        fmt::print(stderr, "{}\n", made.fault());
        return kExitUnfit;
    }
    CpuEngine& engine = *made.engine;
    const ContainmentTest& containment_test = *made.containment_test;
    CycleParts& parts = made.cycle;
    ChosenEngine chosen =
        choose_and_report(loaded, engine, arguments.engine, cycle_demand(machine, is_stoppable));
    if (chosen.refusal != EngineRefusal::none) {
        return exit_code_of(chosen.refusal);
    }
    GuardChain chain(machine, chosen.engine(engine), containment_test, parts.chain());
    double speed_share = 1.0 / kSpeedCapRapid, lost_s = 0;
    const bool keeps_cap = machine.guard.cap != CapPromise::none;
    const bool is_slowed = arguments.obeys_cap || parts.margin_advisory() != nullptr || keeps_cap;
    double* const share = is_slowed ? &speed_share : nullptr;
    options.speed_share = keeps_cap ? nullptr : share;
    options.obeys_cap = arguments.obeys_cap;
    const MotionLimits limits = make_motion_limits(machine);
    AxisShares axis_shares;
    keep_caps(machine, limits.smooth_s, share, &axis_shares, options.board);
    options.lost_s = keeps_cap ? &lost_s : nullptr;
    const MotionOptions motion;
    DriveCsv csv(machine);
    PathJudge judge(machine, engine.engine(), containment_test);
    const auto page = arguments.report.empty()
                          ? nullptr
                          : std::make_unique<PageRecorder>(loaded, engine.engine());
    const bool wants_length = arguments.obeys_cap || keeps_cap || isatty(STDERR_FILENO) == 1;
    const double whole_s = wants_length ? motion_seconds(reading.program, limits, motion) : 0;
    ProgramLines lines{.program = arguments.gcode.program};
    const DriveResult result =
        run_observed(arguments, machine, chain, gcode.start,
                     make_program_motion(reading.program, limits, motion,
                                         options.board.axis_shares == nullptr ? share : nullptr,
                                         &lost_s, options.board.axis_shares),
                     whole_s, options, csv, page.get(), judge, lines);
    lines.read_as = read_as_text(reading.read_as);
    add_blocks(lines, reading.text);
    const bool is_finished = result.state == BoardState::finished;
    if (result.samples >= arguments.gcode.samples_max) {
        fmt::print(stderr, "{}: program: {}\n", arguments.gcode.program,
                   too_many_samples(arguments.gcode.samples_max));
        return kExitInput;
    }
    const double free_s = (arguments.obeys_cap || keeps_cap) && is_finished ? whole_s : 0;
    const bool has_cap = parts.speed_advisory() != nullptr;
    DriveReport report{machine,        engine.engine(), result,  arguments.gcode.program,
                       arguments.mode, arguments.seed,  has_cap, free_s};
    report.contact = judge.contact();
    report.lines = std::move(lines);
    if (!is_finished) {
        look_for_ways_out(arguments, loaded, containment_test, options, report);
        advise(arguments, loaded, containment_test, reading.program, gcode.start, report);
    }
    return write_results(arguments, loaded, report, csv, page.get(), report_if_gave_up(chosen));
}

/// An option that needs the guard in this process, and its replacement with --bus.
struct GuardOption {
    Option option;
    const char* instead;
};

/// True: one of them was passed with --bus, and a message was printed.
bool refuses(const std::vector<GuardOption>& options, const std::string& bus) {
    for (const GuardOption& one : options) {
        if (one.option.is_given()) {
            fmt::print(stderr, "{}. With --bus, the guard on {} is a separate program.\n",
                       one.instead, bus);
            return true;
        }
    }
    return false;
}

}  // namespace

void add_drive(CommandLine& line) {
    const auto arguments = std::make_shared<DriveArguments>();
    const Command command = line.add_command(
        "drive", "Run a program on a simulated motion board with the guard in the loop");
    command.set_group("Try programs");
    command.set_example(
        "axguard drive config/machines/paper-trunnion.yaml "
        "hil_replay/programs/paper-trunnion-demo.ngc");
    add_machine_options(command, arguments->machine);
    add_gcode_options(command, arguments->gcode);
    command
        .add_option("--bus", arguments->bus,
                    "simulate the board in real time on this CAN interface, such as vcan0, for a "
                    "running axguardd")
        .check([](const std::string& name) {
            return std::string(name.empty() ? "empty name. Pass an interface name, such as vcan0."
                                            : "");
        });
    const Option mode = command
                            .add_option("--mode", arguments->mode,
                                        "stoppable: require a stop certificate for every sample; "
                                        "contact: check only the sampled pose")
                            .one_of({"contact", "stoppable"})
                            .shows_default();
    const Option engine = command
                              .add_option("--engine", arguments->engine,
                                          "cpu, cuda (GPU) or auto (selected by measurement) "
                                          "[default: from the machine file]")
                              .one_of({"cpu", "cuda", "auto"});
    command.add_flag("--obey-cap", arguments->obeys_cap,
                     "obey the permit's speed cap and report the time lost to it");
    const Option advice =
        command
            .add_option("--advice-s", arguments->advice_s,
                        "drive a stop within this many seconds again with other values of the "
                        "machine file; prints those that stop nearer; 0: none")
            .between(0.0, 1e6)
            .shows_default();
    const Option jog_out = command.add_flag(
        "--jog-out", arguments->jogs_out,
        "after a stop: jog along the best way out until other motion is permitted");
    command.add_option("--seed", arguments->seed, "seed of all random values").shows_default();
    const Option faults =
        command.add_option("--faults", arguments->faults,
                           "bus faults: rates lost=0.01,late=..,corrupted=..,permit-lost=.. and "
                           "times in s after the start silent=2.5,killed=..,stuck=..,all-late=..");
    command.add_output("--csv", arguments->csv,
                       "write one CSV line per sample: true axes, board, permit");
    command.add_output("--report", arguments->report,
                       "write one HTML report: the machine in motion, clearances, stops");
    add_details_option(command, arguments->has_details);
    add_json_option(command, arguments->json);
    const std::vector<GuardOption> of_the_guard{
        {mode, "--mode: pass it to axguardd run"},
        {engine, "--engine: pass it to axguardd run"},
        {faults,
         "--faults: not available; disconnect the cable, stop axguardd, or slow the interface with "
         "tc netem"},
        {advice, "--advice-s: not available; no program is run twice on a bus"},
        {jog_out, "--jog-out: not available; each jog needs a newly started guard"}};
    command.set_action([arguments, of_the_guard] {
        return arguments->bus.empty()                  ? run_drive(*arguments)
               : refuses(of_the_guard, arguments->bus) ? kExitUsage
                                                       : run_bus_drive(*arguments);
    });
}

}  // namespace axg
