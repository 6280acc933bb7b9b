// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/watch_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/system/end_signals.hpp"
#include "firmware_if/system/status_socket.hpp"
#include "hil_replay/watch/watch_page.hpp"
#include "hil_replay/watch/watch_run.hpp"

namespace axg {
namespace {

struct WatchOptions {
    MachineOptions machine;
    std::string bus, socket, trace;
    std::string listen = "127.0.0.1:8642";
};

/// The fault of the options; empty: none.
std::string fault_of(const WatchOptions& options, const std::optional<ListenAddress>& address) {
    if (options.bus.empty() && options.socket.empty() && options.trace.empty()) {
        return "missing option. Pass --bus IF, --socket PATH or --trace FILE.";
    }
    if (!options.bus.empty() && !options.trace.empty()) {
        return "--trace replaces --bus. Leave one of them out.";
    }
    if (!address) {
        return "--listen: invalid address (found " + quoted(options.listen) +
               ", expected ADDRESS:PORT, numeric).";
    }
    return {};
}

/// The status socket: the stated one, else the service's.
std::string status_path_of(const WatchOptions& options) {
    return options.bus.empty() ? options.socket : status_path(options.bus, options.socket);
}

/// False: `fault` has the failure and the next step.
bool open_bus(const WatchOptions& options, const Machine& machine, WatchSources& sources,
              std::string& fault) {
    if (!options.bus.empty()) {
        sources.bus = WatchedBus::open_interface(machine, options.bus, fault);
    } else if (!options.trace.empty()) {
        sources.bus = WatchedBus::open_trace_file(options.trace, fault);
    }
    return fault.empty();
}

int watch(const WatchOptions& options) {
    const std::optional<ListenAddress> address = read_listen_address(options.listen);
    std::string fault = fault_of(options, address);
    if (!fault.empty()) {
        fmt::print(stderr, "axguard: {}\n", fault);
        return kExitUsage;
    }
    LoadedMachine loaded;
    if (const int code = load(options.machine, loaded); code != kExitClean) {
        return code;
    }
    std::optional<HttpParts> parts = watch_parts(loaded, stderr);
    if (!parts) {
        return kExitInternal;
    }
    WatchSources sources{.bus = {}, .status_path = status_path_of(options)};
    if (!open_bus(options, loaded.machine, sources, fault)) {
        fmt::print(stderr, "axguard: {}\n", fault);
        return options.bus.empty() ? kExitInput : kExitCan;
    }
    EndSignals signals;  // before the threads, which then leave them to this one
    const std::unique_ptr<HttpServer> server =
        HttpServer::start(*address, std::move(*parts), fault);
    if (!server) {
        fmt::print(stderr, "axguard: {}\n", fault);
        return HttpServer::is_built() ? kExitUsage : kExitInternal;
    }
    if (!address->is_loopback) {
        fmt::print(stderr,
                   "axguard: warning: --listen {}: every computer that reaches this address can "
                   "watch the machine; there is no authentication\n",
                   options.listen);
    }
    fmt::print(stderr, "axguard: {} at http://{}{}{}:{}/; Ctrl-C ends\n",
               escaped(loaded.machine.name), address->is_ipv6 ? "[" : "", address->host,
               address->is_ipv6 ? "]" : "", server->port());
    run_watch(loaded, std::move(sources), *server, [&signals] { return signals.was_sent(); });
    return kExitClean;
}

}  // namespace

void add_watch(CommandLine& line) {
    auto options = std::make_shared<WatchOptions>();
    const Command command =
        line.add_command("watch", "Show a running guard as a live page in a browser, read-only");
    command.set_group("Watch a guard");
    command.set_example("axguard watch machine.yaml --bus can0");
    add_machine_options(command, options->machine);
    command.add_option("--bus", options->bus,
                       "CAN interface to listen on; sends nothing. Also reads the status socket of "
                       "the service on it");
    command.add_option("--socket", options->socket,
                       "status socket of the guard, if started with --status-socket");
    command.add_input("--trace", options->trace,
                      "play this recorded trace at its own speed instead of a bus");
    command
        .add_option("--listen", options->listen,
                    "address and port of the page; any but a loopback address serves other "
                    "computers, without authentication")
        .shows_default();
    command.set_action([options] { return watch(*options); });
}

}  // namespace axg
