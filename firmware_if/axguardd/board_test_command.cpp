// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/board_test_command.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <memory>
#include <string>

#include "config/machine/effective_text.hpp"
#include "firmware_if/axguardd/admission_command.hpp"
#include "firmware_if/axguardd/board_test_record.hpp"
#include "firmware_if/axguardd/latency_command.hpp"
#include "firmware_if/board_test/board_player.hpp"
#include "firmware_if/board_test/board_report.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/guard/live_ids.hpp"
#include "firmware_if/system/end_signals.hpp"
#include "firmware_if/system/live_socket.hpp"
#include "firmware_if/system/one_guard.hpp"
#include "firmware_if/system/real_time.hpp"

namespace axg {
namespace {

constexpr std::int64_t kTurnUs = 20'000;      // between two looks at the clock
constexpr std::int64_t kEchoWaitUs = 20'000;  // for the last frame to leave

struct BoardTestArguments {
    MachineOptions machine;
    std::string bus, cap = "none", state_dir = "/var/lib/axguardd", keys_file, serial;
    BoardTestOptions test;
    double person_seconds = 120;
    int cpu = -1, priority = 80;
    bool is_agreed = false;
    JsonOutput report;
};

/// Explains what will happen, and requires a person's consent.
bool is_agreed(const BoardTestArguments& arguments) {
    fmt::print(
        stderr,
        "board-test on {}: ALL AXES MAY MOVE, and stop hard about forty times.\n"
        "  - The travel is free: no workpiece, no tool, no person within reach.\n"
        "  - The emergency stop is at hand. A board that fails a rule may not stop by itself.\n"
        "  - A program is loaded that moves an axis to and fro, far and at an even feed.\n"
        "  - No guard runs on this bus. Before each case a person arms the board.\n",
        arguments.bus);
    if (arguments.is_agreed) {
        return true;
    }
    if (isatty(STDIN_FILENO) == 0) {
        fmt::print(stderr, "axguardd: no terminal for the confirmation. In scripts, pass --yes.\n");
        return false;
    }
    fmt::print(stderr, "Type yes to start: ");
    std::string word;
    std::getline(std::cin, word);
    return word == "yes";
}

std::string record_path(const BoardTestArguments& arguments) {
    return board_test_path(arguments.state_dir, arguments.bus);
}

/// Checks before any motion that a record can be written: its path, and the serial number or a
/// person to type it. Empty, or the fault.
std::string record_fault(const BoardTestArguments& arguments) {
    const bool is_asked = !arguments.is_agreed && isatty(STDIN_FILENO) != 0;
    if (arguments.keys_file.empty()) {
        return arguments.serial.empty() ? "" : "--serial needs --write, which stores the record";
    }
    if (arguments.serial.empty()) {
        return is_asked ? record_place_fault(record_path(arguments))
                        : "--write stores a record of this board. Pass its serial number with "
                          "--serial TEXT.";
    }
    const std::string fault = serial_fault(arguments.serial);
    return fault.empty() ? record_place_fault(record_path(arguments)) : "--serial: " + fault;
}

/// False: no valid serial number; the record would name no board.
bool ask_serial(BoardTestArguments& arguments) {
    if (arguments.keys_file.empty() || !arguments.serial.empty()) {
        return true;
    }
    fmt::print(stderr, "Serial number of the board, as on its label: ");
    std::getline(std::cin, arguments.serial);
    const std::string fault = serial_fault(arguments.serial);
    if (!fault.empty()) {
        fmt::print(stderr, "axguardd: {}\n", fault);
    }
    return fault.empty();
}

/// As far as the system allows: the player detects a late permit and repeats its case.
void be_on_time(const BoardTestArguments& arguments) {
    for (const std::string& words :
         {lock_memory(), stay_on_cpu(arguments.cpu),
          arguments.priority > 0 ? take_priority(arguments.priority) : std::string()}) {
        if (!words.empty()) {
            fmt::print(stderr, "axguardd: {}\n", words);
        }
    }
}

void tell(const BoardPlayer& player, PersonTask& told, const BoardCase*& last) {
    const PersonTask task = player.task();
    if (task == told && player.current() == last) {
        return;
    }
    told = task;
    last = player.current();
    if (task != PersonTask::nothing && last != nullptr) {
        fmt::print(stderr, "{}: {} Then arm the board and start it.\n", last->name,
                   task == PersonTask::arm_jog ? "Choose a slow jog of one axis."
                                               : "Choose the program, and no jog.");
    }
}

/// Waits until this instant, or until a frame arrives.
void wait_until(const SocketCan& wire, std::int64_t until_us) {
    const std::int64_t left_us = std::clamp<std::int64_t>(until_us - monotonic_us(), 0, kTurnUs);
    const timespec timeout{.tv_sec = 0, .tv_nsec = left_us * 1000};
    pollfd wait{.fd = wire.descriptor(), .events = POLLIN, .revents = 0};
    ppoll(&wait, 1, &timeout, nullptr);
}

/// False: the bus is gone, and the player is interrupted.
bool exchange(const Machine& machine, SocketCan& wire, BoardPlayer& player) {
    CanArrival arrival;
    ReadStatus status = wire.read(arrival);
    for (; status == ReadStatus::frame; status = wire.read(arrival)) {
        const CanFrame& frame = arrival.frame;
        if (!arrival.is_own && !frame.error && !frame.extended &&
            is_guard_id(machine.can, frame.id)) {
            player.interrupt(fmt::format("another guard sends 0x{:03X}. Stop it first.", frame.id));
        }
        player.on_frame(frame, arrival.is_own);
    }
    if (status == ReadStatus::down || status == ReadStatus::gone) {
        player.interrupt(fmt::format("the interface is {}", to_text(status)));
        return false;
    }
    player.on_time(monotonic_us());
    for (CanFrame frame; player.take(monotonic_us(), frame);) {
        const SendStatus sent = wire.send(frame);
        if (sent != SendStatus::ok && sent != SendStatus::busy) {
            player.interrupt(fmt::format("the interface is {}", to_text(sent)));
            return false;
        }
    }
    return true;
}

/// Called after the keys are written: a record without them would name no existing configuration.
bool write_record(const BoardTestArguments& arguments, const LoadedMachine& loaded,
                  const BoardTestResult& result) {
    const std::string path = record_path(arguments);
    if (const std::string fault = record_place_fault(path); !fault.empty()) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return false;
    }
    const BoardTestRecord record{
        loaded.machine.name,
        arguments.bus,
        arguments.serial,
        fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))),
        configuration_hashes(with_measured_keys(loaded.machine, result), loaded.meshes),
        counts_of(result),
        result.abandoned};
    return write_whole_file(path, describe_record(record), stderr);
}

int report(const BoardTestArguments& arguments, const LoadedMachine& loaded,
           const BoardTestResult& result) {
    const Machine& machine = loaded.machine;
    const BoardTestCounts counts = counts_of(result);
    const std::string keys = machine_keys(machine, result);
    fmt::print(arguments.report.words(), "{}{}{} passed, {} FAILED, {} unclear, {} not tested\n",
               report_text(result),
               result.abandoned.empty() ? "" : "ended early: " + result.abandoned + '\n',
               counts.passed, counts.failed, counts.unclear, counts.not_tested);
    bool is_written = true;
    if (arguments.keys_file.empty()) {
        fmt::print(arguments.report.words(), "{}", keys);
    } else {
        is_written = (keys.empty() || write_whole_file(arguments.keys_file, keys, stderr)) &&
                     write_record(arguments, loaded, result);
    }
    is_written =
        write_json(arguments.report, describe_board_test(machine, arguments.bus, result)) &&
        is_written;
    return !is_written                                       ? kExitInternal
           : counts.failed > 0                               ? kExitUnfit
           : counts.unclear > 0 || !result.abandoned.empty() ? kExitCan
                                                             : kExitClean;
}

/// Plays until the test is over and its last frame is on the bus.
void play(const Machine& machine, SocketCan& wire, BoardPlayer& player) {
    EndSignals signals;
    PersonTask told = PersonTask::nothing;
    const BoardCase* last = nullptr;
    bool has_bus = true;
    while (has_bus && !player.is_over()) {
        wait_until(wire, player.next_due_us());
        if (signals.was_sent()) {
            player.interrupt("interrupted");
        }
        has_bus = exchange(machine, wire, player);
        tell(player, told, last);
    }
    for (const std::int64_t end_us = monotonic_us() + kEchoWaitUs;
         has_bus && monotonic_us() < end_us;) {
        wait_until(wire, end_us);
        has_bus = exchange(machine, wire, player);
    }
    (void)signals.was_sent();  // nothing moves any more: the report is to be written
}

int test_board(BoardTestArguments& arguments, const LoadedMachine& loaded) {
    const Machine& machine = loaded.machine;
    arguments.test.hashes = configuration_hashes(machine, loaded.meshes);
    arguments.test.person_us_max = static_cast<std::int64_t>(arguments.person_seconds * 1e6);
    arguments.test.cap = arguments.cap == "all_axes"   ? CapPromise::all_axes
                         : arguments.cap == "per_axis" ? CapPromise::per_axis
                                                       : CapPromise::none;
    std::string fault = BoardPlayer(machine, arguments.test).unplayed();
    if (!fault.empty()) {
        fmt::print(stderr, "axguardd: --only {}: {}\n", arguments.test.only, fault);
        return kExitUsage;
    }
    std::optional<SocketCan> wire = open_live_socket(machine, arguments.bus, 0, fault);
    if (!wire) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitCan;
    }
    if (!is_agreed(arguments) || !ask_serial(arguments)) {
        return kExitUsage;
    }
    be_on_time(arguments);
    BoardPlayer player(machine, arguments.test);
    wire->forget();
    play(machine, *wire, player);
    return report(arguments, loaded, player.result());
}

/// Rejects pipes and devices: they could block the program after it has moved the machine.
std::string report_fault(const std::string& name) {
    struct stat found {};
    const bool is_file = name == "-" || stat(name.c_str(), &found) != 0 || S_ISREG(found.st_mode);
    return is_file ? std::string()
                   : "is not a regular file. Pass a new file name, or - for stdout.";
}

int run_board_test(BoardTestArguments& arguments) {
    if (const std::string fault = record_fault(arguments); !fault.empty()) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitUsage;
    }
    const OneGuard claimed(arguments.state_dir, arguments.bus);
    if (claimed.status() != OneGuard::Status::mine) {
        fmt::print(stderr, "axguardd: {}\n", claimed.fault());
        return claimed.status() == OneGuard::Status::held ? kExitCan : kExitInput;
    }
    LoadedMachine loaded;
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    if (!is_testable(loaded.machine.can)) {
        fmt::print(stderr,
                   "axguardd: {}: the board does not read permits (found can.format {}, expected "
                   "classical or fd)\n",
                   arguments.machine.file, wire_of(loaded.machine.can).name);
        return kExitInput;
    }
    return may_run(arguments.machine.file, loaded.machine) ? test_board(arguments, loaded)
                                                           : kExitInput;
}

std::string case_fault(const std::string& name) {
    std::string names;
    for (const BoardCase& one : board_cases()) {
        if (name == one.name) {
            return {};
        }
        names += fmt::format("{}{}", names.empty() ? "" : ", ", one.name);
    }
    return fmt::format("unknown case (expected one of {})", names);
}

}  // namespace

bool is_testable(const CanLayout& can) noexcept {
    return is_native(can);
}

void add_board_test(CommandLine& line) {
    const auto arguments = std::make_shared<BoardTestArguments>();
    const Command command = line.add_command(
        "board-test",
        "Test a motion board on a bench against the rules of docs/reference/board.md");
    command.set_example("axguardd board-test machine.yaml --bus can0 -o report.json");
    add_machine_options(command, arguments->machine);
    add_bus_option(command, arguments->bus);
    arguments->report.files = command.files();
    command.add_output("-o,--output", arguments->report.target, "write the report as JSON")
        .check(report_fault);
    command
        .add_output("--write", arguments->keys_file,
                    "write the measured machine-file keys to this file [default: stdout]")
        .check(report_fault);
    command.add_option("--serial", arguments->serial,
                       "serial number of the board, for the record that --write stores "
                       "[default: prompted for]");
    command
        .add_option("--only", arguments->test.only,
                    "run only this case, after the cases run and lapse")
        .check(case_fault);
    command.add_option("--cap", arguments->cap, "speed cap that the board supports")
        .one_of({"none", "all_axes", "per_axis"});
    command.add_flag("--jog", arguments->test.has_jog, "run the jog cases too");
    command.add_flag("--yes", arguments->is_agreed, "start without confirmation (for scripts)");
    command
        .add_option("--person-seconds", arguments->person_seconds,
                    "time allowed for arming the board, s")
        .between(1.0, 86400.0)
        .shows_default();
    command.add_flag("--local-board", arguments->test.accepts_local,
                     "accept frames sent by this host (vcan testing only)");
    command
        .add_option("--state-dir", arguments->state_dir, "folder of the lock file and the record")
        .shows_default();
    add_thread_options(command, arguments->cpu, arguments->priority);
    command.set_action([arguments] { return run_board_test(*arguments); });
}

}  // namespace axg
