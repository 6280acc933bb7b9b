// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/run_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "config/machine/effective_text.hpp"
#include "config/text/quote_text.hpp"
#include "core/machine/cycle_plan.hpp"
#include "firmware_if/axguardd/admission_command.hpp"
#include "firmware_if/axguardd/axguardd_json.hpp"
#include "firmware_if/axguardd/board_test_command.hpp"
#include "firmware_if/axguardd/board_test_record.hpp"
#include "firmware_if/axguardd/doctor_command.hpp"
#include "firmware_if/axguardd/latency_command.hpp"
#include "firmware_if/axguardd/live_engines.hpp"
#include "firmware_if/axguardd/live_threads.hpp"
#include "firmware_if/axguardd/status_command.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/guard_exit.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/proof_test/proof_test_command.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/cycle_parts.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/unstated_promises.hpp"
#include "firmware_if/system/gpio_line.hpp"
#include "firmware_if/system/latch_file.hpp"
#include "firmware_if/system/live_socket.hpp"
#include "firmware_if/system/one_guard.hpp"

namespace axg {
namespace {

struct RunArguments {
    MachineOptions machine;
    std::string bus, engine, mode = "stoppable", state_dir = "/var/lib/axguardd";
    std::int32_t receive_buffer_bytes = 0;
    ThreadOptions threads;
    AdmissionOptions admission;
    std::string status_socket;  // empty: none
    JsonOutput json;
};

int exit_code_of(const LiveEnd& end, bool has_gpu_fault) {
    if (has_gpu_fault) {
        return kExitGpu;
    }
    if (end.is_wire_gone) {
        return kExitCan;
    }
    return end.guard.phase == GuardPhase::stopped ? exit_code_of(end.guard.cause) : kExitClean;
}

/// Opens the machine file's output line, if it names one. False: the reason is in `fault`.
bool open_line(const OutputLine& wanted, std::optional<GpioLine>& line, std::string& fault) {
    if (!wanted.chip.empty()) {
        line = GpioLine::open("/dev/" + wanted.chip, wanted.line, fault);
    }
    return wanted.chip.empty() || line;
}

/// The options of the threads, with the header of a black-box dump for this run.
ThreadOptions with_black_box(const RunArguments& arguments, const LoadedMachine& loaded,
                             PulseLine* line) {
    ThreadOptions threads = arguments.threads;
    threads.guard.line = line;
    threads.black_box =
        black_box_header(loaded, arguments.mode == "stoppable", threads.guard.accepts_local);
    threads.compares_hashes = loaded.machine.can.hashes_in_id != 0;
    threads.guard.hashes = configuration_hashes(loaded.machine, loaded.meshes);
    threads.dumps.folder = arguments.state_dir;
    threads.dumps.bus = arguments.bus;
    return threads;
}

/// Prints the end of the run. Returns the exit code.
int report_end(const RunArguments& arguments, const Machine& machine, const LiveEngines& engines,
               const LiveEnd& end) {
    if (!end.fault.empty()) {
        fmt::print(stderr, "axguardd: {}\n", end.fault);
        return kExitUnfit;
    }
    const char* const gpu_fault = engines.chosen.gpu ? engines.chosen.gpu->fault() : nullptr;
    if (gpu_fault != nullptr) {
        fmt::print(stderr, "axguardd: GPU failed: {}\n", gpu_fault);
    }
    fmt::print(stderr, "axguardd: {}; {} samples, {} permits, {} late, {} guard frames failed\n",
               to_text(end.guard.phase), end.counters.snapshots, end.counters.permits,
               end.counters.late, end.counters.send_faults);
    const bool is_written = write_json(
        arguments.json,
        describe_run({machine.name, arguments.bus, arguments.mode, machine.can.hashes_in_id != 0},
                     end));
    return is_written ? exit_code_of(end, gpu_fault != nullptr) : kExitInternal;
}

/// Whether the guard may start here: every check passed, or a person waived each one that failed.
/// Prints the verdict.
bool is_admitted(const RunArguments& arguments, const LoadedMachine& loaded, LiveEngines& engines,
                 AdmissionGauge& gauge) {
    const ThreadOptions& threads = arguments.threads;
    const AdmissionRun run{arguments.bus,
                           arguments.mode == "stoppable",
                           threads.bus_priority,
                           threads.engine_priority,
                           threads.bus_cpu,
                           threads.engine_cpu,
                           arguments.admission.seconds};
    const AdmissionSubject subject{loaded.machine.name,
                                   configuration_hash(loaded.machine, loaded.meshes), arguments.bus,
                                   arguments.mode, arguments.state_dir};
    const Admission found = admit(run, arguments.admission, subject, loaded, engines);
    const std::vector<std::string>& waived = arguments.admission.waived;
    const bool is_waived = found.verdict.is_waived_by(waived);
    fmt::print(stderr, "{}axguardd: {}{}; {}\n", table_of(found.verdict, true),
               to_text(found.verdict),
               found.verdict.is_fit() ? ""
               : is_waived            ? ", admitted by --admit-unfit"
                                      : ". Correct it, or waive the check with --admit-unfit CHECK",
               found.is_written ? admission_path(arguments.state_dir, arguments.bus)
                                : "verdict not stored");
    gauge = gauge_of(found.verdict);
    return is_waived;
}

/// False: the requested status socket could not be opened; prints the reason.
bool open_status(const RunArguments& arguments, StatusSocket& status_socket) {
    if (arguments.status_socket.empty()) {
        return true;
    }
    std::string fault;
    status_socket = StatusSocket::open(arguments.status_socket, fault);
    if (!status_socket.is_open()) {
        fmt::print(stderr, "axguardd: {}\n", fault);
    }
    return status_socket.is_open();
}

void log_start(const RunArguments& arguments, const Machine& machine) {
    fmt::print(stderr, "axguardd: {} on {}, {} mode, permits valid for {} to {} us{}\n",
               machine.name, arguments.bus, arguments.mode, time_limits(machine).least_permit_us,
               time_limits(machine).permit_us,
               arguments.threads.guard.accepts_local
                   ? ", accepting frames of this host as the board's"
                   : "");
}

void log_unstated(const Machine& machine) {
    for (const UnstatedPromise& promise : unstated_promises(machine)) {
        fmt::print(stderr, "axguardd: not stated: {}\n", format_promise(machine, promise));
    }
}

/// Whether a board was tested for this configuration; it decides nothing. Drives and
/// boards of other makers cannot be tested.
FoundRecord log_board_test(const RunArguments& arguments, const LoadedMachine& loaded) {
    const std::string path = board_test_path(arguments.state_dir, arguments.bus);
    FoundRecord found = find_record(path, configuration_hashes(loaded.machine, loaded.meshes));
    if (is_testable(loaded.machine.can)) {
        fmt::print(stderr, "axguardd: {}\n", words_of(found, path));
    }
    return found;
}

/// Does everything that may fail or is slow before the first frame, then runs the guard.
int guard_bus(const RunArguments& arguments, LoadedMachine& loaded) {
    const bool is_stoppable = arguments.mode == "stoppable";
    if (!forget_admission(arguments.state_dir, arguments.bus, stderr)) {
        return kExitInput;
    }
    LiveEngines engines(loaded, arguments.engine, is_stoppable);
    const int code = log_engines(engines);
    if (code != kExitClean) {
        return code;
    }
    if (engines.plan) {
        loaded.machine.plan = engines.plan->plan;
    }
    CycleParts parts(loaded, is_stoppable);
    if (!parts.has_memory()) {
        fmt::print(stderr, "axguardd: {}\n", kNoMemoryForProofs);
        return kExitUnfit;
    }
    const Machine& machine = loaded.machine;
    std::string fault;
    const LatchFile latch = open_latch(arguments.state_dir + "/" + arguments.bus + ".latch", fault);
    if (!latch) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitInput;
    }
    std::optional<SocketCan> wire =
        open_live_socket(machine, arguments.bus, arguments.receive_buffer_bytes, fault);
    if (!wire) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitCan;
    }
    std::optional<GpioLine> line;
    if (!open_line(machine.output_line, line, fault)) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitUnfit;
    }
    StatusSocket status_socket;
    if (!open_status(arguments, status_socket)) {
        return kExitInput;
    }
    const std::string file = std::filesystem::path(arguments.machine.file).filename().string();
    const StatusLine status_line(machine, file, arguments.bus, arguments.mode,
                                 configuration_hash(machine, loaded.meshes),
                                 tested_board(log_board_test(arguments, loaded)));
    ThreadOptions threads = with_black_box(arguments, loaded, line ? &*line : nullptr);
    // Created before the admission, which counts its memory.
    StopDesk desk(loaded, *engines.cpu, *engines.containment_test, file);
    if (!is_admitted(arguments, loaded, engines, threads.admission)) {
        return kExitUnfit;
    }
    if (status_socket.is_open() && status_socket.listen()) {
        threads.status_socket = &status_socket;
    }
    threads.status_line = &status_line;
    threads.desk = &desk;
    const Engine engine = engines.engine();
    GuardChain chain(machine, engine, *engines.containment_test, parts.chain());
    log_start(arguments, machine);
    log_unstated(machine);
    if (is_stoppable) {
        fmt::print(stderr, "axguardd: plan: {}\n", format_plan(parts.stop_certificate()->plan()));
    }
    const LiveEnd end = run_live(machine, chain, *wire, *latch, threads);
    return report_end(arguments, machine, engines, end);
}

/// A signal to arm or reset during the admission must not end the program. Blocks both signals: the
/// main thread serves them when the guard runs, and the guard reports that they have no effect.
void hold_wishes() noexcept {
    sigset_t wishes;
    sigemptyset(&wishes);
    sigaddset(&wishes, SIGUSR1);
    sigaddset(&wishes, SIGUSR2);
    pthread_sigmask(SIG_BLOCK, &wishes, nullptr);
}

/// False: both have one name, and the metrics file would replace the socket.
bool is_socket_free_of_metrics(const RunArguments& arguments) {
    const std::string& metrics = arguments.threads.metrics_file;
    if (metrics.empty() || arguments.status_socket.empty()) {
        return true;
    }
    const auto place = [](const std::string& path) {
        std::error_code error;
        const auto full = std::filesystem::weakly_canonical(path, error);
        return error ? std::filesystem::path(path).lexically_normal() : full;
    };
    const auto socket = place(arguments.status_socket);
    if (socket != place(metrics) && socket != place(metrics + ".part")) {
        return true;
    }
    fmt::print(stderr, "axguardd: --metrics and --status-socket both name {}\n",
               escaped(arguments.status_socket, 4096));
    return false;
}

int run(const RunArguments& arguments) {
    if (!is_socket_free_of_metrics(arguments)) {
        return kExitUsage;
    }
    hold_wishes();
    const OneGuard claimed(arguments.state_dir, arguments.bus);
    if (claimed.status() != OneGuard::Status::mine) {
        fmt::print(stderr, "axguardd: {}\n", claimed.fault());
        return claimed.status() == OneGuard::Status::held ? kExitUnfit : kExitInput;
    }
    LoadedMachine loaded;
    if (const int code = load(arguments.machine, loaded); code != kExitClean) {
        return code;
    }
    return may_run(arguments.machine.file, loaded.machine) ? guard_bus(arguments, loaded)
                                                           : kExitInput;
}

void add_thread_options(const Command& command, RunArguments& arguments) {
    command.add_option("--bus-cpu", arguments.threads.bus_cpu, "CPU of the bus thread")
        .between(0, 1023);
    command.add_option("--engine-cpu", arguments.threads.engine_cpu, "CPU of the engine thread")
        .between(0, 1023);
    command
        .add_option(
            "--priority", arguments.threads.bus_priority,
            "SCHED_FIFO priority of the bus thread (engine thread: 10 lower); 0 = leave unchanged")
        .between(0, 99)
        .shows_default();
    command
        .add_option("--receive-buffer", arguments.receive_buffer_bytes,
                    "size of the socket's receive buffer, bytes [default: from the system]")
        .between(1, 1 << 30);
}

void add_run(CommandLine& line, RunArguments& arguments) {
    const Command command = line.add_command("run", "Guard a machine on a CAN interface");
    command.set_example("axguardd run machine.yaml --bus can0");
    add_machine_options(command, arguments.machine);
    add_bus_option(command, arguments.bus);
    add_guard_options(command, arguments.mode, arguments.engine, arguments.state_dir);
    command
        .add_option("--black-boxes", arguments.threads.dumps.dumps_max,
                    "number of black-box dumps to keep, one for each stop; 0 = write none")
        .between(0, 1000)
        .shows_default();
    command
        .add_output("--metrics", arguments.threads.metrics_file,
                    "write metrics for the Prometheus node exporter to this file, once a second")
        .check([](const std::string& path) {
            std::error_code error;
            const auto status = std::filesystem::symlink_status(path, error);
            const bool is_file =
                !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
            return std::string(
                is_file && path != "-"
                    ? ""
                    : "not a regular file (the file is replaced). Pass a new file name.");
        });
    command
        .add_option(
            "--status-socket", arguments.status_socket,
            "serve the guard's state on this socket (read it with axguardd status) [default: none]")
        .check([](const std::string& path) {
            return std::string(
                path.empty() ? "empty name. Pass a socket name, or leave the option out." : "");
        });
    command.add_flag("--local-board", arguments.threads.guard.accepts_local,
                     "accept frames sent by this host (vcan testing only)");
    add_thread_options(command, arguments);
    add_seconds_option(command, "--admit-seconds", arguments.admission);
    command
        .add_option("--admit-unfit", arguments.admission.waived,
                    "start even if the named admission check fails; repeatable")
        .separated_by(',')
        .one_of({"system", "latency", "engine", "cycle", "memory"});
    add_json_option(command, arguments.json);
    command.set_action([&arguments] {
        ThreadOptions& threads = arguments.threads;
        threads.bus = arguments.bus;
        threads.engine_priority = std::max(0, threads.bus_priority - 10);
        return run(arguments);
    });
}

}  // namespace

int run_axguardd(std::vector<std::string> words) {
    CommandLine line({.name = "axguardd",
                      .purpose = "axguardd: collision guard for a five-axis machine on its CAN bus",
                      .version = AXG_VERSION});
    RunArguments arguments;
    add_run(line, arguments);
    add_latency_test(line);
    add_doctor(line);
    add_admit(line);
    add_status(line);
    add_board_test(line);
    add_proof_test(line);
    line.add_completion();
    return line.parse_command(std::move(words), "Run axguardd --help for the list.");
}

}  // namespace axg
