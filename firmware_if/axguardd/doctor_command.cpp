// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/doctor_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "firmware_if/axguardd/axguardd_json.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/system/fitness.hpp"

namespace axg {
namespace {

struct DoctorArguments {
    SystemRequest system;
    std::string bus;
    JsonOutput json;
};

int examine(const DoctorArguments& arguments) {
    std::vector<Finding> findings = check_system(arguments.system);
    if (!arguments.bus.empty()) {
        std::optional<CanLink> link;
        std::string fault;
        if (arguments.system.root.empty()) {
            link = request_can_link(arguments.bus, fault);
        }
        const auto more = check_bus(arguments.system.root, arguments.bus, link);
        findings.insert(findings.end(), more.begin(), more.end());
    }
    std::array<int, 3> counts{};
    for (const Finding& finding : findings) {
        ++counts[static_cast<std::size_t>(finding.fitness)];
        fmt::print(arguments.json.words(), "{:<5} {:<16} {}\n", to_text(finding.fitness),
                   finding.subject, finding.found);
        if (!finding.mend.empty()) {
            fmt::print(arguments.json.words(), "{:<22} -> {}\n", "", finding.mend);
        }
    }
    const bool is_fit = counts[static_cast<std::size_t>(Fitness::bad)] == 0;
    fmt::print(arguments.json.words(), "{} OK, {} WARN, {} BAD: {}\n", counts[0], counts[1],
               counts[2],
               is_fit ? "fit; measure the wake-up latency with axguardd latency-test" : "NOT FIT");
    const bool is_written = write_json(arguments.json, describe_findings(findings));
    return !is_written ? kExitInternal : is_fit ? kExitClean : kExitUnfit;
}

}  // namespace

void add_doctor(CommandLine& line) {
    const auto arguments = std::make_shared<DoctorArguments>();
    const Command command = line.add_command(
        "doctor", "Check this host for settings that delay the guard or lose CAN frames");
    command.set_example("axguardd doctor --bus can0 --bus-cpu 3 --engine-cpu 2");
    SystemRequest& system = arguments->system;
    command.add_option("--bus", arguments->bus, "CAN interface to check too");
    command.add_option("--bus-cpu", system.bus_cpu, "CPU of the bus thread").between(0, 1023);
    command.add_option("--engine-cpu", system.engine_cpu, "CPU of the engine thread")
        .between(0, 1023);
    command
        .add_option(
            "--priority", system.priority,
            "SCHED_FIFO priority of the bus thread (engine thread: 10 lower); 0 = leave unchanged")
        .between(0, 99)
        .shows_default();
    command.add_option("--root", system.root,
                       "folder with a copy of another host's /proc and /sys; disables netlink");
    add_json_option(command, arguments->json);
    command.set_action([arguments] { return examine(*arguments); });
}

}  // namespace axg
