// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/status_server.hpp"

#include <poll.h>

#include <array>

#include "firmware_if/can/socket_can.hpp"

namespace axg {
namespace {

constexpr int kConnectionWaitMs = 100;  // then it looks whether the guard ends

void pause_ms(int wait_ms) noexcept {
    poll(nullptr, 0, wait_ms);
}

/// False: the bus thread provided no view.
bool take_view(StatusExchange& exchange, const std::atomic<bool>& is_ending,
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

}  // namespace

void serve_status(const StatusSocket& socket, const StatusLine& line, StatusExchange& exchange,
                  WhyDesk* why, const std::atomic<bool>& is_ending) noexcept {
    LiveView view;
    GuardWhy distances;
    bool has_view = false;
    std::array<char, kStatusLineBytesMax> text{};
    while (!is_ending.load()) {
        if (!socket.await(kConnectionWaitMs)) {
            continue;
        }
        const auto make_text = [&] {
            has_view = take_view(exchange, is_ending, view) || has_view;
            if (has_view && why != nullptr) {
                distances = why->why(view.stop_query, view.withheld);
            }
            return std::span(text).first(
                line.write(has_view ? &view : nullptr, distances, monotonic_us(), text));
        };
        if (socket.serve(make_text) == 0) {
            pause_ms(kViewWaitMs);  // no descriptors are left: no reason to be busy
        }
    }
}

}  // namespace axg
