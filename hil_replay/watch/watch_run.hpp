// SPDX-License-Identifier: Apache-2.0
// axguard watch at work: bus and status in, one state for the page twenty times a second out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/watch/http_server.hpp"
#include "hil_replay/watch/watch_state.hpp"
#include "hil_replay/watch/watched_bus.hpp"

namespace axg {

inline constexpr std::int64_t kPageEveryUs = 50'000;

struct WatchSources {
    std::unique_ptr<WatchedBus> bus;        // null: none
    std::optional<WatchedTraces> traces{};  // nullopt: the bus is not recorded
    std::string status_path;                // empty: none
};

/// Runs until `is_ended` returns true; calls it once for each state of the page.
/// @param loaded  must outlive it
void run_watch(const LoadedMachine& loaded, WatchSources sources, HttpServer& server,
               const std::function<bool()>& is_ended);

}  // namespace axg
