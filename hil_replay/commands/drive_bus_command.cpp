// SPDX-License-Identifier: Apache-2.0
// axguard drive --bus: the simulated motion board on a CAN interface in real time, for a guard that
// is another program. One thread plays the board; this one waits, then judges and reports.
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "core/guard/margin_advisory.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_parts.hpp"
#include "firmware_if/system/live_socket.hpp"
#include "firmware_if/system/real_time.hpp"
#include "hil_replay/board/socket_clock.hpp"
#include "hil_replay/commands/details_option.hpp"
#include "hil_replay/commands/drive_command.hpp"
#include "hil_replay/drive/bus_drive.hpp"
#include "hil_replay/drive/path_record.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "hil_replay/page/run_page.hpp"

namespace axg {
namespace {

// Above the guard's threads (80, 70): like a real board, this one never waits for them.
constexpr int kBoardPriority = 85;
constexpr auto kLookEvery = std::chrono::milliseconds(20);

std::atomic<bool> g_is_ended{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void end_by_signal(int /*signal*/) {
    g_is_ended.store(true);
}

/// The first Ctrl-C ends the drive; the second one ends the program, as ever.
void catch_signals() {
    struct sigaction action {};
    action.sa_handler = end_by_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

/// After the drive a signal ends the program again, and removes partly written files.
void release_signals() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

/// The board at one sample, for the table and the page that are made afterwards.
struct BoardSample {
    std::uint64_t sample = 0;
    std::int64_t time_us = 0;
    BoardState state = BoardState::waiting;
    std::uint16_t tool = 0;
    bool has_permit = false;
    std::array<double, kAxesMax> position{};
};

BoardSample sample_of(const MotionBoard& board, std::int64_t period_us) {
    BoardSample out{.sample = board.samples() - 1,
                    .time_us = board.next_latch_us() - period_us,
                    .state = board.state(),
                    .tool = board.tool()};
    out.has_permit = board.permits().valid_until_us() > out.time_us;
    for (std::size_t i = 0; i < board.axes().size(); ++i) {
        out.position[i] = board.axes()[i].position;
    }
    return out;
}

std::string csv_of(const Machine& machine, const std::deque<BoardSample>& samples) {
    std::string text = csv_head(machine) + ",permit\n";
    for (const BoardSample& one : samples) {
        text += fmt::format("{},{}{},{}\n", one.sample, to_text(one.state),
                            csv_axes(machine, one.position), one.has_permit ? 1 : 0);
    }
    return text;
}

bool write_page_of(const DriveArguments& arguments, const LoadedMachine& loaded,
                   const DriveReport& report, const std::deque<BoardSample>& samples) {
    const auto page = std::make_unique<PageRecorder>(loaded, report.engine);
    for (const BoardSample& one : samples) {
        AxisSnapshot snapshot;
        snapshot.sample = one.sample;
        snapshot.latched_us = snapshot.arrived_us = one.time_us;
        snapshot.axis_count = static_cast<std::uint32_t>(loaded.machine.axes.size());
        snapshot.tool = one.tool;
        snapshot.position = one.position;
        page->note(snapshot, {.has_permit = one.has_permit});
    }
    return write_page(arguments, loaded, report, page->finish());
}

/// Plays the board in a thread of its own, and writes here what it does.
BusDriveResult play(const DriveArguments& arguments, const LoadedMachine& loaded, SocketCan& wire,
                    std::span<const double> start, CommandedMotion motion,
                    const BusDriveOptions& options, PathRecord& path,
                    std::deque<BoardSample>& samples, ProgramLines& lines) {
    const Machine& machine = loaded.machine;
    std::atomic<BoardState> state{BoardState::waiting};
    std::atomic<bool> is_over{false};
    const bool wants_samples = !arguments.csv.empty() || !arguments.report.empty();
    BusDriveObservers observers;
    observers.watch = [&](std::int64_t time_us, const MotionBoard& board) {
        path.add(time_us, board.axes(), board.tool());
    };
    observers.each = [&](const MotionBoard& board) {
        state.store(board.state());
        add_program_step(lines, board.next_latch_us() - machine.can.sample_us, board.line());
        if (wants_samples) {
            samples.push_back(sample_of(board, machine.can.sample_us));
        }
    };
    BusDriveResult result;
    std::string refusal;
    std::thread thread([&] {
        refusal = take_priority(kBoardPriority);
        result = drive_on_bus(machine, wire, socket_clock(wire), start, std::move(motion), options,
                              g_is_ended, observers);
        is_over.store(true);
    });
    fmt::print(stderr,
               "{}: the board of {} waits for a permit, sample period {} us; arm the guard, or end "
               "with Ctrl-C\n",
               arguments.bus, machine.name, machine.can.sample_us);
    for (BoardState shown = BoardState::waiting; !is_over.load();) {
        std::this_thread::sleep_for(kLookEvery);
        const BoardState now = state.load();
        if (now != shown) {
            fmt::print(stderr, "{}: {}\n", arguments.bus, to_text(now));
            shown = now;
        }
    }
    thread.join();
    if (!refusal.empty()) {
        fmt::print(stderr, "{}: {}\n", arguments.bus, refusal);
    }
    return result;
}

/// The wire's part of the exit code.
int exit_code_of_bus(const DriveArguments& arguments, const Machine& machine,
                     const BusDriveResult& result, bool has_contact) {
    if (result.wire.other_board_id != 0) {
        fmt::print(stderr,
                   "{}: another sender uses the board's CAN id 0x{:X}; no frame was sent. End that "
                   "program or disconnect that board.\n",
                   arguments.bus, result.wire.other_board_id);
        return kExitCan;
    }
    const int code = exit_code_of(arguments, machine, result.drive, has_contact);
    return result.wire.is_lost && !has_contact && code == kExitCollision ? kExitCan : code;
}

/// False: a file was not written; the reason is printed.
bool write_outputs(const DriveArguments& arguments, const LoadedMachine& loaded,
                   const DriveReport& report, const std::deque<BoardSample>& samples) {
    bool is_written = arguments.csv.empty() ||
                      write_whole_file(arguments.csv, csv_of(loaded.machine, samples), stderr);
    is_written = (arguments.report.empty() || write_page_of(arguments, loaded, report, samples)) &&
                 is_written;
    return write_json(arguments.json, describe_drive(report)) && is_written;
}

/// The exit code, after a message, for what the simulated board on a bus does not support.
int refuse(const DriveArguments& arguments, const Machine& machine) {
    if (machine.can.guard_sends_sync) {
        fmt::print(stderr,
                   "{}: can.sync: guard conflicts with --bus, whose board sends SYNC. Leave --bus "
                   "out, or use sync: board with sync_counter: 240.\n",
                   arguments.machine.file);
        return kExitInput;
    }
    if (arguments.obeys_cap && !machine.guard.speed_cap) {
        fmt::print(stderr,
                   "--obey-cap: the guard of {} sends no speed cap. Set guard.speed_cap, or leave "
                   "the option out.\n",
                   machine.name);
        return kExitUsage;
    }
    return kExitClean;
}

/// The board that the machine file promises, with the configuration that was read.
BusDriveOptions bus_options(const DriveArguments& arguments, const Machine& machine,
                            const DriveOptions& read) {
    BusDriveOptions options{.board = promised_live_board(machine, arguments.seed),
                            .obeys_cap = arguments.obeys_cap};
    options.board.tick_us = kMotionStepUs;
    options.board.hashes = read.board.hashes;
    return options;
}

/// Text and files. Returns the exit code.
int write_results(const DriveArguments& arguments, const LoadedMachine& loaded,
                  const BusDriveResult& result, const DriveReport& report,
                  const std::deque<BoardSample>& samples) {
    const int exit_code =
        exit_code_of_bus(arguments, loaded.machine, result, report.contact.has_value());
    if (result.drive.encoded.status == EncodeStatus::ok) {
        print_drive(report, detail_of(arguments.has_details), arguments.json.words());
    }
    return write_outputs(arguments, loaded, report, samples) ? exit_code : kExitInternal;
}

}  // namespace

int run_bus_drive(const DriveArguments& arguments) {
    LoadedMachine loaded;
    DriveOptions read;
    GcodeOptions gcode;
    GcodeResult reading;
    const int refused = read_inputs(arguments, loaded, read, gcode, reading);
    if (refused != kExitClean) {
        return refused;
    }
    const Machine& machine = loaded.machine;
    if (const int code = refuse(arguments, machine); code != kExitClean) {
        return code;
    }
    GuardParts parts(loaded, false);  // to judge the path: the guard is another program
    if (!parts.fault().empty()) {
        fmt::print(stderr, "{}\n", parts.fault());
        return kExitUnfit;
    }
    const ContainmentTest& containment_test = *parts.containment_test;
    std::string fault;
    std::optional<SocketCan> wire = open_live_socket(machine, arguments.bus, 0, fault);
    if (!wire) {
        fmt::print(stderr, "{}\n", fault);
        return kExitCan;
    }
    double speed_share = 1.0 / kSpeedCapRapid, lost_s = 0;
    BusDriveOptions options = bus_options(arguments, machine, read);
    const bool keeps_cap = machine.guard.cap != CapPromise::none;
    const bool is_slowed = arguments.obeys_cap || has_clearance_levels(machine) || keeps_cap;
    double* const share = is_slowed ? &speed_share : nullptr;
    options.speed_share = keeps_cap ? nullptr : share;
    options.lost_s = keeps_cap ? &lost_s : nullptr;
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    AxisShares axis_shares;
    keep_caps(machine, limits.smooth_s, share, &axis_shares, options.board);
    const double whole_s =
        arguments.obeys_cap || keeps_cap ? motion_seconds(reading.program, limits, motion) : 0;
    PathRecord path;
    std::deque<BoardSample> samples;
    ProgramLines lines{.program = arguments.gcode.program};
    catch_signals();
    const BusDriveResult result =
        play(arguments, loaded, *wire, {gcode.start.data(), machine.axes.size()},
             make_program_motion(reading.program, limits, motion,
                                 options.board.axis_shares == nullptr ? share : nullptr, &lost_s,
                                 options.board.axis_shares),
             options, path, samples, lines);
    release_signals();
    lines.read_as = read_as_text(reading.read_as);
    add_blocks(lines, reading.text);
    PathJudge judge(machine, parts.engine->engine(), containment_test);
    path.show(judge);
    const bool is_finished = result.drive.state == BoardState::finished;
    DriveReport report{machine,
                       parts.engine->engine(),
                       result.drive,
                       arguments.gcode.program,
                       arguments.mode,
                       arguments.seed,
                       machine.guard.speed_cap || keeps_cap,
                       is_finished ? whole_s : 0};
    report.contact = judge.contact();
    report.lines = std::move(lines);
    report.bus = BusReport{.interface = arguments.bus, .wire = result.wire};
    if (!is_finished) {
        look_for_ways_out(arguments, loaded, containment_test, read, report);
    }
    return write_results(arguments, loaded, result, report, samples);
}

}  // namespace axg
