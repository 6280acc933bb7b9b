// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/status_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "firmware_if/axguardd/status_json.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {
namespace {

struct StatusArguments {
    std::string bus, socket;
    JsonOutput json;
};

int show_status(const StatusArguments& arguments) {
    if (arguments.bus.empty() == arguments.socket.empty()) {
        fmt::print(stderr, "axguardd: missing option. Pass either --bus IF or --socket PATH.\n");
        return kExitUsage;
    }
    const std::string path = status_path(arguments.bus, arguments.socket);
    std::string fault;
    const std::string line = read_status(path, fault);
    if (!fault.empty()) {
        fmt::print(stderr, "axguardd: {}\n", fault);
        return kExitInput;
    }
    const std::optional<StatusWords> words = words_of_status(line);
    if (!words) {
        fmt::print(stderr,
                   "axguardd: {}: incompatible status: the guard runs another axguardd version\n",
                   path);
        return kExitInput;
    }
    fmt::print(arguments.json.words(), "{}", words->text);
    return write_json(arguments.json, words->json) ? words->exit_code : kExitInternal;
}

}  // namespace

void add_status(CommandLine& line) {
    const auto arguments = std::make_shared<StatusArguments>();
    const Command command = line.add_command(
        "status", "Print the state of a running guard and its reason; needs no root");
    command.set_example("axguardd status --bus can0");
    command.add_option("--bus", arguments->bus, "CAN interface of a guard that runs as a service");
    command.add_option("--socket", arguments->socket,
                       "socket of the guard, if started with --status-socket");
    add_json_option(command, arguments->json);
    command.set_action([arguments] { return show_status(*arguments); });
}

}  // namespace axg
