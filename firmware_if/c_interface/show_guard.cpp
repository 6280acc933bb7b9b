// SPDX-License-Identifier: Apache-2.0
// axg_guard_show: the guard of another process is shown by the code that shows axguardd's.
#include <algorithm>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "config/machine/effective_text.hpp"
#include "firmware_if/c_interface/guard_object.hpp"
#include "firmware_if/c_interface/live_view_of.hpp"
#include "firmware_if/can/socket_can.hpp"

namespace axg {

LiveView live_view_of(const axg_guard& guard, std::int64_t now_us) noexcept {
    const GuardNode& live = *guard.guard;
    const bool is_stopped = live.guard().phase == GuardPhase::stopped;
    const std::int64_t shift_us = monotonic_us() - now_us;
    return {.phase = live.guard().phase,
            .cause = live.guard().cause,
            .counters = live.counters(),
            .input = live.receiver().counters(),
            .time_us = now_us + shift_us,
            .phase_us = live.phase_us() + shift_us,
            .reason = live.reason(),
            .pair = live.pair(),
            .stop_query = live.stop_query(),
            .program_line = is_stopped ? guard.program_line : 0,
            .withheld = live.withheld(),
            .stands = live.stands(now_us),
            .is_confirmed = live.guard().is_confirmed,
            .has_session = live.has_said_session(),
            .admission = std::nullopt,
            .compares_hashes = guard.loaded.machine.can.hashes_in_id != 0};
}

namespace {

constexpr std::size_t kNameMax = 32;

/// Part of file names, and of the labels of metrics.
bool is_name(std::string_view name) noexcept {
    return !name.empty() && name.size() <= kNameMax &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '-' || c == '_';
           });
}

std::string text_of(const char* text) {
    return text == nullptr ? "" : text;
}

/// Empty: shown. Else why not.
std::string show(axg_guard& guard, const axg_show_options& wanted) {
    const Machine& machine = guard.loaded.machine;
    const char* const mode = guard.is_stoppable ? "stoppable" : "contact";
    guard.line.emplace(machine, guard.file, wanted.name, mode,
                       configuration_hash(machine, guard.loaded.meshes));
    const LiveServiceOptions options{
        .name = wanted.name,
        .status_socket = text_of(wanted.status_socket),
        .metrics_file = text_of(wanted.metrics_file),
        .black_box =
            black_box_header(guard.loaded, guard.is_stoppable, guard.options.accepts_local),
        .dumps = {text_of(wanted.state_dir), wanted.name, wanted.black_boxes}};
    std::string fault;
    auto service = std::make_unique<LiveService>(machine, *guard.line, *guard.desk, options, fault);
    if (fault.empty()) {
        service->start();
        guard.service = std::move(service);
        guard.options.black_box = wanted.black_boxes != 0 ? &guard.service->records() : nullptr;
    }
    return fault;
}

}  // namespace
}  // namespace axg

extern "C" axg_status axg_guard_show(axg_guard* guard, const axg_show_options* options, char* text,
                                     size_t text_bytes) {
    const auto put = [&](std::string_view words) {
        if (text != nullptr && text_bytes != 0) {
            const std::size_t size = std::min(words.size(), text_bytes - 1);
            std::memcpy(text, words.data(), size);
            text[size] = '\0';
        }
    };
    put("");
    if (guard == nullptr || guard->guard || guard->service || options == nullptr) {
        return AXG_STATUS_BAD_CALL;
    }
    if (options->name == nullptr || !axg::is_name(options->name)) {
        put("name: expected 1 to 32 letters, digits, - or _");
        return AXG_STATUS_BAD_CALL;
    }
    if (options->black_boxes != 0 && options->state_dir == nullptr) {
        put("black_boxes: no folder. Set state_dir.");
        return AXG_STATUS_BAD_CALL;
    }
    try {
        const std::string fault = axg::show(*guard, *options);
        put(fault);
        return fault.empty() ? AXG_STATUS_OK : AXG_STATUS_BAD_CALL;
    } catch (const std::bad_alloc&) {
        return AXG_STATUS_NO_MEMORY;
    } catch (const std::system_error&) {
        put("cannot start a thread. Close other programs, or see ulimit -u.");
        return AXG_STATUS_NO_MEMORY;
    } catch (...) {
        return AXG_STATUS_INTERNAL;
    }
}
