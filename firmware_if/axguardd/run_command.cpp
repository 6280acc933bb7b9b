// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/run_command.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "config/effective_text.hpp"
#include "firmware_if/axguardd/doctor_command.hpp"
#include "firmware_if/axguardd/latch_file.hpp"
#include "firmware_if/axguardd/latency_command.hpp"
#include "firmware_if/axguardd/live_threads.hpp"
#include "firmware_if/gpio_line.hpp"
#include "hil_replay/choose_engine.hpp"
#include "hil_replay/commands.hpp"
#include "hil_replay/guard_engine.hpp"
#include "hil_replay/guard_exit.hpp"
#include "hil_replay/help_example.hpp"
#include "hil_replay/json_output.hpp"
#include "hil_replay/machine_options.hpp"

namespace axg {
namespace {

struct RunArguments {
    MachineOptions machine;
    std::string bus, engine, mode = "stoppable", state_dir = "/var/lib/axguardd";
    std::int32_t receive_buffer_bytes = 0;
    ThreadOptions threads;
    JsonOutput json;
};

/// One guard an interface: a name that the kernel gives away once in each network, as interfaces
/// are, and takes back whatever way the process ends. Negative: `fault` says why it is not ours.
int claim(const std::string& bus, std::string& fault) {
    const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (socket < 0) {
        fault = fmt::format("no socket: {}; see ulimit -n", std::strerror(errno));
        return -1;
    }
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = "axguardd/" + bus;  // behind a zero byte: no file
    std::copy_n(name.begin(), std::min(name.size(), sizeof address.sun_path - 1),
                address.sun_path + 1);
    shutdown(socket, SHUT_RD);  // a name and nothing else: whoever writes to it gets EPIPE
    if (bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
        return socket;
    }
    fault =
        errno == EADDRINUSE
            ? fmt::format("another axguardd guards {}; end that one first: pgrep -a axguardd", bus)
            : fmt::format("{} cannot be claimed: {}", bus, std::strerror(errno));
    close(socket);
    return -1;
}

std::optional<SocketCan> open_bus(const RunArguments& arguments, const Machine& machine,
                                  std::string& fault) {
    SocketOptions options;
    options.interface = arguments.bus;
    static_assert(kLiveIdsMax <= kCanFiltersMax);
    options.ids.count = live_ids(machine, options.ids.id);
    const AxisFrameSet set = make_frame_set(machine);
    options.is_fd =
        std::find(set.is_flexible.begin(), set.is_flexible.end(), true) != set.is_flexible.end();
    options.receive_buffer_bytes = arguments.receive_buffer_bytes;
    return SocketCan::open(options, fault);
}

int exit_code_of(const LiveEnd& end, bool has_gpu_fault) {
    if (has_gpu_fault) {
        return kExitGpu;
    }
    if (end.is_wire_gone) {
        return kExitCan;
    }
    return end.guard.phase == GuardPhase::stopped ? exit_code_of(end.guard.cause) : kExitClean;
}

nlohmann::json describe(const RunArguments& arguments, const Machine& machine, const LiveEnd& end) {
    nlohmann::json faults = nlohmann::json::object();
    for (std::uint32_t i = 0; i < kReceiverFaults; ++i) {
        const auto fault = static_cast<ReceiverFault>(i);
        if (end.input.of(fault) != 0) {
            faults[fault_row(fault).name] = end.input.of(fault);
        }
    }
    const LiveCounters& counters = end.counters;
    return {{"machine", machine.name},
            {"bus", arguments.bus},
            {"mode", arguments.mode},
            {"phase", to_text(end.guard.phase)},
            {"cause", to_text(end.guard.cause)},
            {"reason", to_text(end.reason)},
            {"pictures", counters.pictures},
            {"permits", counters.permits},
            {"permits_slow", counters.slow},
            {"stop_frames", counters.stops},
            {"late", counters.late},
            {"refused", counters.refused},
            {"echoes", counters.echoes},
            {"send_faults", counters.send_faults},
            {"turns_cut_short", counters.frames_left},
            {"samples_lost", end.input.samples_lost},
            {"frames_dropped", end.frames_dropped},
            {"records_lost", counters.records_lost},
            {"black_box", end.dump},
            {"receiver_faults", faults}};
}

/// The machine file's line, if it names one. False: it cannot be had, and `fault` says why.
bool open_line(const OutputLine& wanted, std::optional<GpioLine>& line, std::string& fault) {
    if (!wanted.chip.empty()) {
        line = GpioLine::open("/dev/" + wanted.chip, wanted.line, fault);
    }
    return wanted.chip.empty() || line;
}

/// The options of the threads, with what a dump of the black box says of this run.
ThreadOptions with_box(const RunArguments& arguments, const LoadedMachine& loaded,
                       PulseLine* line) {
    ThreadOptions threads = arguments.threads;
    threads.guard.line = line;
    const std::string hash = configuration_hash(loaded.machine, loaded.meshes);
    std::copy_n(hash.begin(), std::min(hash.size(), threads.box.configuration.size()),
                threads.box.configuration.begin());
    threads.guard.hashes = configuration_hashes(loaded.machine, loaded.meshes);
    threads.box.is_stoppable = arguments.mode == "stoppable";
    threads.box.accepts_local = threads.guard.accepts_local;
    threads.dumps.folder = arguments.state_dir;
    threads.dumps.bus = arguments.bus;
    return threads;
}

/// Everything that is fallible and slow, before the first frame.
int guard_bus(const RunArguments& arguments, const LoadedMachine& loaded) {
    std::optional<CpuEngine> cpu = make_engine(loaded);
    const std::optional<Solids> solids = cpu ? make_solids(loaded, *cpu) : std::nullopt;
    const bool is_stoppable = arguments.mode == "stoppable";
    std::optional<StopPlan> plan = solids && is_stoppable ? make_stop_plan(loaded) : std::nullopt;
    const bool has_cap = plan && loaded.machine.guard.speed_cap;
    std::optional<SpeedHint> hint = has_cap ? SpeedHint::create(loaded.machine) : std::nullopt;
    const bool is_levelled = has_levels(loaded.machine);
    std::optional<MarginHint> levels =
        is_levelled ? MarginHint::create(loaded.machine) : std::nullopt;
    if (!solids || (is_stoppable && !plan) || (has_cap && !hint) || (is_levelled && !levels)) {
        fmt::print(stderr, "axguardd: {}\n",
                   !cpu      ? kNoLaneSet
                   : !solids ? kNoMemoryForSolids
                             : kNoMemoryForProofs);
        return kExitUnfit;
    }
    const Machine& machine = loaded.machine;
    const CycleDemand demand = is_stoppable ? stoppable_demand(machine, machine.deadline_us)
                                            : contact_demand(machine.deadline_us);
    ChosenEngine chosen =
        choose_engine(loaded, *cpu, engine_choice(arguments.engine, machine), demand);
    if (!chosen.words.empty()) {
        fmt::print(stderr, "axguardd: {}\n", chosen.words);
    }
    if (chosen.exit_code != kExitClean) {
        return chosen.exit_code;
    }
    std::string fault;
    const LatchFile latch = open_latch(arguments.state_dir + "/" + arguments.bus + ".latch", fault);
    if (!latch) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitInput;
    }
    std::optional<SocketCan> wire = open_bus(arguments, machine, fault);
    if (!wire) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitCan;
    }
    std::optional<GpioLine> line;
    if (!open_line(machine.output_line, line, fault)) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitUnfit;
    }
    const Engine engine = chosen.engine(*cpu);
    GuardChain chain(machine, engine, *solids, plan ? &*plan : nullptr, hint ? &*hint : nullptr,
                     levels ? &*levels : nullptr);
    fmt::print(
        stderr, "axguardd: {} on {}, {} mode, a permit lasts {} us{}\n", machine.name,
        arguments.bus, arguments.mode, machine.can.permit_samples * machine.can.sample_us,
        arguments.threads.guard.accepts_local ? ", frames of this host are the board's" : "");
    const LiveEnd end = run_live(machine, engine, chain, *wire, *latch,
                                 with_box(arguments, loaded, line ? &*line : nullptr));
    if (!end.fault.empty()) {
        fmt::print(stderr, "axguardd: {}\n", end.fault);
        return kExitUnfit;
    }
    const char* const gpu_fault = chosen.gpu ? chosen.gpu->fault() : nullptr;
    if (gpu_fault != nullptr) {
        fmt::print(stderr, "axguardd: the GPU gave up: {}\n", gpu_fault);
    }
    fmt::print(stderr, "axguardd: {}; {} pictures, {} permits, {} late, {} frames of ours failed\n",
               to_text(end.guard.phase), end.counters.pictures, end.counters.permits,
               end.counters.late, end.counters.send_faults);
    const bool is_written = write_json(arguments.json, describe(arguments, machine, end));
    return is_written ? exit_code_of(end, gpu_fault != nullptr) : kExitInternal;
}

int run(const RunArguments& arguments) {
    std::string fault;
    const int claimed = claim(arguments.bus, fault);
    if (claimed < 0) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitUnfit;
    }
    LoadedMachine loaded;
    const int code =
        load(arguments.machine, loaded, stderr) ? guard_bus(arguments, loaded) : kExitInput;
    close(claimed);
    return code;
}

void add_run(CLI::App& app, RunArguments& arguments, int& exit_code) {
    CLI::App* command = app.add_subcommand("run", "Guards a machine on a CAN interface");
    put_example_first(*command, "axguardd run machine.yaml --bus can0");
    add_machine_options(*command, arguments.machine);
    command->add_option("--bus", arguments.bus, "CAN interface, as ip link names it")->required();
    command
        ->add_option("--mode", arguments.mode,
                     "stoppable: every stop that may still come; contact: each sampled pose alone")
        ->check(CLI::IsMember({"contact", "stoppable"}));
    command
        ->add_option("--engine", arguments.engine,
                     "cpu, cuda (a GPU) or auto; default: the machine file's")
        ->check(CLI::IsMember({"cpu", "cuda", "auto"}));
    command->add_option("--state-dir", arguments.state_dir,
                        "folder of the latch and of the black box, which outlive the program");
    command
        ->add_option("--black-boxes", arguments.threads.dumps.dumps_max,
                     "dumps of the black box that are kept, one a stop; 0: none is written")
        ->check(CLI::Range(0, 1000));
    command->add_option("--metrics", arguments.threads.metrics_file,
                        "text file for the Prometheus node exporter, written once a second");
    command->add_flag("--local-board", arguments.threads.guard.accepts_local,
                      "take frames sent by this host for the board's: vcan, where all are");
    command->add_option("--bus-cpu", arguments.threads.bus_cpu, "processor of the bus thread")
        ->check(CLI::Range(0, 1023));
    command
        ->add_option("--engine-cpu", arguments.threads.engine_cpu, "processor of the engine thread")
        ->check(CLI::Range(0, 1023));
    command
        ->add_option("--priority", arguments.threads.bus_priority,
                     "SCHED_FIFO of the bus thread, the engine ten below; 0: none")
        ->check(CLI::Range(0, 99));
    command
        ->add_option("--receive-buffer", arguments.receive_buffer_bytes,
                     "bytes of the socket's queue; default: the system's")
        ->check(CLI::Range(1, 1 << 30));
    add_json_option(*command, arguments.json);
    command->callback([&arguments, &exit_code] {
        ThreadOptions& threads = arguments.threads;
        threads.bus = arguments.bus;
        threads.engine_priority = std::max(0, threads.bus_priority - 10);
        exit_code = run(arguments);
    });
}

}  // namespace

int run_axguardd(std::vector<std::string> words) {
    CLI::App app{"axguardd: guards a five-axis machine on its CAN bus", "axguardd"};
    app.set_version_flag("--version", AXG_VERSION);
    app.require_subcommand(1);
    int exit_code = kExitClean;
    RunArguments arguments;
    add_run(app, arguments, exit_code);
    add_latency_test(app, exit_code);
    add_doctor(app, exit_code);
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    try {
        app.parse(words);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitClean : kExitUsage;
    }
    return exit_code;
}

}  // namespace axg
