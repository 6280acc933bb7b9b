// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/admission_command.hpp"

#include <fmt/format.h>
#include <net/if.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "config/machine/effective_text.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/axguardd/axguardd_json.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/guard/live_refusal.hpp"
#include "firmware_if/system/one_guard.hpp"

namespace axg {
namespace {

struct AdmitArguments {
    MachineOptions machine;
    std::string engine, mode = "stoppable", state_dir = "/var/lib/axguardd";
    AdmissionRun run;
    AdmissionOptions options;
    JsonOutput json;
};

int admit_alone(const AdmitArguments& arguments, const LoadedMachine& loaded) {
    if (!forget_admission(arguments.state_dir, arguments.run.bus, stderr)) {
        return kExitInput;
    }
    LiveEngines engines(loaded, arguments.engine, arguments.run.is_stoppable);
    const int code = log_engines(engines);
    if (code != kExitClean) {
        return code;
    }
    const AdmissionSubject subject{loaded.machine.name,
                                   configuration_hash(loaded.machine, loaded.meshes),
                                   arguments.run.bus, arguments.mode, arguments.state_dir};
    const Admission found = admit(arguments.run, arguments.options, subject, loaded, engines);
    fmt::print(arguments.json.words(), "{}{}\n", table_of(found.verdict, false),
               to_text(found.verdict));
    const bool is_written = write_json(arguments.json, found.document) && found.is_written;
    return !is_written ? kExitInternal : found.verdict.is_fit() ? kExitClean : kExitUnfit;
}

int run_admit(const AdmitArguments& arguments) {
    const OneGuard claimed(arguments.state_dir, arguments.run.bus);
    if (claimed.status() != OneGuard::Status::mine) {
        fmt::print(stderr, "axguardd: {}\n", claimed.fault());
        return claimed.status() == OneGuard::Status::held ? kExitUnfit : kExitInput;
    }
    LoadedMachine loaded;
    const int code = load(arguments.machine, loaded);
    if (code != kExitClean) {
        return code;
    }
    return may_run(arguments.machine.file, loaded.machine) ? admit_alone(arguments, loaded)
                                                           : kExitInput;
}

}  // namespace

void add_seconds_option(const Command& command, const std::string& name,
                        AdmissionOptions& options) {
    command
        .add_option(name, options.seconds,
                    "duration of the wake-up measurement before the guard starts, s")
        .between(0.01, 3600.0)
        .shows_default();
}

void add_guard_options(const Command& command, std::string& mode, std::string& engine,
                       std::string& state_dir) {
    command
        .add_option("--mode", mode,
                    "stoppable: require a stop certificate for every sample; contact: check only "
                    "the sampled pose")
        .one_of({"contact", "stoppable"})
        .shows_default();
    command
        .add_option(
            "--engine", engine,
            "cpu, cuda (GPU) or auto (selected by measurement) [default: from the machine file]")
        .one_of({"cpu", "cuda", "auto"});
    command
        .add_option("--state-dir", state_dir, "folder for the verdict, the latch and the black box")
        .shows_default();
}

void add_bus_option(const Command& command, std::string& bus) {
    command.add_option("--bus", bus, "CAN interface, such as can0")
        .required()
        .check([](const std::string& name) {
            const bool is_name = !name.empty() && name.size() < IFNAMSIZ &&
                                 name.find_first_of("/ \t\n") == std::string::npos && name != "." &&
                                 name != "..";
            return is_name ? std::string()
                           : fmt::format(
                                 "invalid interface name (found {}, expected 1 to {} characters "
                                 "without / or blank, such as can0)",
                                 quoted(name, 80), IFNAMSIZ - 1);
        });
}

bool may_run(const std::string& machine_file, const Machine& machine) {
    const std::vector<std::string> refusals = live_refusals(machine);
    for (const std::string& refusal : refusals) {
        fmt::print(stderr, "axguardd: {}: {}\n", machine_file, refusal);
    }
    for (const std::string& warning : live_warnings(machine)) {
        fmt::print(stderr, "axguardd: {}: warning: {}\n", machine_file, warning);
    }
    return refusals.empty();
}

bool forget_admission(const std::string& state_dir, const std::string& bus, std::FILE* messages) {
    const std::string path = admission_path(state_dir, bus);
    const bool is_gone = unlink(path.c_str()) == 0 || errno == ENOENT;
    if (!is_gone) {
        fmt::print(messages,
                   "axguardd: {}: cannot remove the verdict of an earlier start: {}. Pass a "
                   "writable folder with --state-dir DIR.\n",
                   path, std::strerror(errno));
    }
    return is_gone;
}

Admission admit(const AdmissionRun& run, const AdmissionOptions& options,
                const AdmissionSubject& subject, const LoadedMachine& loaded,
                LiveEngines& engines) {
    AdmissionRun measured = run;
    measured.seconds = options.seconds;
    const AdmissionFigures figures = measure_admission(measured, loaded, engines);
    Admission out;
    out.verdict = judge_admission(figures);
    out.document = describe_admission(out.verdict, figures, subject, options.waived);
    out.is_written =
        write_whole_file(admission_path(subject.state_dir, subject.bus), out.document, stderr);
    return out;
}

void add_admit(CommandLine& line) {
    const auto arguments = std::make_shared<AdmitArguments>();
    const Command command = line.add_command(
        "admit", "Measure whether this host is fit to run the guard and store the verdict");
    command.set_example("axguardd admit machine.yaml --bus can0 --bus-cpu 3 --engine-cpu 2");
    add_machine_options(command, arguments->machine);
    AdmissionRun& run = arguments->run;
    add_bus_option(command, run.bus);
    add_guard_options(command, arguments->mode, arguments->engine, arguments->state_dir);
    command.add_option("--bus-cpu", run.bus_cpu, "CPU of the bus thread").between(0, 1023);
    command.add_option("--engine-cpu", run.engine_cpu, "CPU of the engine thread").between(0, 1023);
    command
        .add_option(
            "--priority", run.bus_priority,
            "SCHED_FIFO priority of the bus thread (engine thread: 10 lower); 0 = leave unchanged")
        .between(0, 99)
        .shows_default();
    add_seconds_option(command, "--seconds", arguments->options);
    add_json_option(command, arguments->json);
    command.set_action([arguments] {
        arguments->run.is_stoppable = arguments->mode == "stoppable";
        arguments->run.engine_priority = std::max(0, arguments->run.bus_priority - 10);
        return run_admit(*arguments);
    });
}

}  // namespace axg
