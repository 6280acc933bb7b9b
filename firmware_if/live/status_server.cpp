// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/live/status_server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <new>
#include <string>
#include <vector>

#include "firmware_if/can/socket_can.hpp"
#include "firmware_if/explain/why_sentences.hpp"

namespace axg {
namespace {

constexpr int kConnectionWaitMs = 100;  // then it looks whether the guard ends

void pause_ms(int wait_ms) noexcept {
    poll(nullptr, 0, wait_ms);
}

/// False: the bus thread provided no view.
bool take_view(ViewExchange& exchange, const std::atomic<bool>& is_ending,
               LiveView& view) noexcept {
    LiveView old;
    while (exchange.views.pop(old)) {  // a late view of an earlier request
    }
    exchange.is_wanted.store(true);
    for (int i = 0; i < kViewTries && !is_ending.load(); ++i) {
        pause_ms(kViewWaitMs);
        if (exchange.views.pop(view)) {
            return true;
        }
    }
    return false;
}

/// Returns less without memory; the guard runs on.
StatusWhy why_of(const LiveView& view, StopDesk& desk) noexcept {
    StatusWhy out;
    try {
        if (view.phase == GuardPhase::stopped) {
            out.stop = desk.view({.cause = view.cause,
                                  .reason = view.reason,
                                  .pair = view.pair,
                                  .query = view.stop_query,
                                  .is_confirmed = view.is_confirmed});
            out.stop.account.program_line = view.program_line;
        }
        out.withheld = desk.withheld(view.withheld);
        out.tool = desk.tool();
    } catch (const std::bad_alloc&) {
    }
    return out;
}

void log_stop(StopLog& log, const LiveView& view, const StatusWhy& why) noexcept {
    try {
        log.note(view, why.stop.account);
    } catch (const std::bad_alloc&) {
    }
}

}  // namespace

void StopLog::note(const LiveView& view, const StopAccount& account) {
    const bool is_stopped = view.phase == GuardPhase::stopped;
    if (is_stopped && stop_us_ == view.phase_us && was_confirmed_ == view.is_confirmed) {
        return;
    }
    printed_ = is_stopped && stop_us_ == view.phase_us ? printed_ : 1;
    stop_us_ = is_stopped ? view.phase_us : -1;
    was_confirmed_ = view.is_confirmed;
    if (!is_stopped) {
        return;
    }
    const std::vector<std::string> sentences = stop_sentences(account);
    for (; printed_ < sentences.size(); ++printed_) {
        const std::string line = fmt::format("{}.{:06}   {}\n", view.time_us / 1'000'000,
                                             view.time_us % 1'000'000, sentences[printed_]);
        [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), line.size());
    }
}

void serve_status(const StatusService& service, ViewExchange& exchange,
                  const std::atomic<bool>& is_ending) noexcept {
    LiveView view;
    StatusWhy why;
    bool has_view = false;
    std::array<char, kStatusLineBytesMax> text{};
    const auto refresh = [&] {
        has_view = take_view(exchange, is_ending, view) || has_view;
        if (has_view && service.desk != nullptr) {
            why = why_of(view, *service.desk);
        }
        if (has_view && service.log != nullptr) {
            log_stop(*service.log, view, why);
        }
    };
    const auto make_text = [&] {
        refresh();
        return std::span(text).first(
            service.line->write(has_view ? &view : nullptr, why, monotonic_us(), text));
    };
    while (!is_ending.load()) {
        if (service.socket == nullptr) {
            pause_ms(kConnectionWaitMs);
        } else if (service.socket->await(kConnectionWaitMs)) {
            if (service.socket->serve(make_text) == 0) {
                pause_ms(kViewWaitMs);  // no descriptors are left: no reason to be busy
            }
            continue;
        }
        if (service.log != nullptr) {
            refresh();
        }
    }
}

}  // namespace axg
