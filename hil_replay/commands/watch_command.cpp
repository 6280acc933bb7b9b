// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/watch_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/system/end_signals.hpp"
#include "firmware_if/system/status_socket.hpp"
#include "hil_replay/watch/watch_page.hpp"
#include "hil_replay/watch/watch_run.hpp"
#include "hil_replay/watch/watched_trace.hpp"

namespace axg {
namespace {

struct WatchOptions {
    MachineOptions machine;
    std::string bus, socket;
    std::vector<std::string> traces;
    std::string listen = "127.0.0.1:8642";
};

/// The fault of the options; empty: none.
std::string fault_of(const WatchOptions& options, const std::optional<ListenAddress>& address) {
    if (options.bus.empty() && options.socket.empty() && options.traces.empty()) {
        return "missing option. Pass --bus IF, --socket PATH or --trace FILE.";
    }
    if (!options.bus.empty() && !options.traces.empty()) {
        return "--trace replaces --bus. Leave one of them out.";
    }
    if (!address) {
        return "--listen: invalid address (found " + axg::quoted(options.listen) +
               ", expected ADDRESS:PORT, numeric).";
    }
    return {};
}

/// The status socket: the stated one, else the service's.
std::string status_path_of(const WatchOptions& options) {
    return options.bus.empty() ? options.socket : status_path(options.bus, options.socket);
}

/// Looks for what is missing in the traces, and opens them. False: as open_bus().
bool open_traces(const WatchOptions& options, const LoadedMachine& loaded, WatchSources& sources,
                 std::string& fault) {
    std::vector<TraceContent> contents;
    for (const std::string& path : options.traces) {
        std::error_code error;
        if (path == "-" || std::filesystem::is_fifo(path, error)) {
            fmt::print(stderr, "axguard: {}: read to its end first. For a live bus use --bus.\n",
                       escaped(path, 200));
        }
        std::optional<TraceContent> content = read_content(loaded.machine, path, fault);
        if (!content) {
            return false;
        }
        contents.push_back(std::move(*content));
    }
    fault = fault_of_traces(contents);
    if (!fault.empty()) {
        return false;
    }
    sources.traces.emplace();
    sources.traces->has_guard =
        std::any_of(contents.begin(), contents.end(),
                    [](const TraceContent& content) { return content.of_guard != 0; });
    sources.traces->notes = notes_about(contents, loaded.machine, options.machine.file);
    sources.bus = WatchedBus::open_traces(options.traces, fault);
    return sources.bus != nullptr;
}

/// False: `fault` has the failure and the next step.
bool open_bus(const WatchOptions& options, const LoadedMachine& loaded, WatchSources& sources,
              std::string& fault) {
    if (!options.traces.empty()) {
        return open_traces(options, loaded, sources, fault);
    }
    if (!options.bus.empty()) {
        sources.bus = WatchedBus::open_interface(loaded.machine, options.bus, fault);
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
    WatchSources sources{.bus = {}, .traces = {}, .status_path = status_path_of(options)};
    if (!open_bus(options, loaded, sources, fault)) {
        fmt::print(stderr, "axguard: {}\n", fault);
        return options.bus.empty() ? kExitInput : kExitCan;
    }
    if (sources.traces) {
        for (const std::string& note : sources.traces->notes) {
            fmt::print(stderr, "axguard: note: {}\n", note);
        }
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
    command
        .add_option("--trace", options->traces,
                    "play this recorded trace at its own speed instead of a bus; again for the "
                    "guard's trace of the same time")
        .repeatable();
    command
        .add_option("--listen", options->listen,
                    "address and port of the page; any but a loopback address serves other "
                    "computers, without authentication")
        .shows_default();
    command.set_action([options] { return watch(*options); });
}

}  // namespace axg
