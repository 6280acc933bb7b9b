// SPDX-License-Identifier: Apache-2.0
// The status thread: for each client it requests a copy of the bus thread's state and sends it as a
// line. Clients cannot slow the bus thread down, however many: it reads one flag a turn, and copies
// at most once in kViewWaitMs.
#pragma once

#include <atomic>

#include "firmware_if/axguardd/metrics.hpp"
#include "firmware_if/axguardd/status_json.hpp"
#include "firmware_if/guard/spsc_queue.hpp"
#include "firmware_if/guard/why_desk.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {

inline constexpr int kViewWaitMs = 20;
inline constexpr int kViewTries = 10;  // then the last view is served, with its age

/// Between the bus thread and the status thread.
struct StatusExchange {
    std::atomic<bool> is_wanted{false};
    SpscQueue<LiveView, 2> views{};
};

/// The bus thread, once a turn.
/// @param view  creates the view; called only for a client
template <class MakeView>
void answer(StatusExchange& exchange, const MakeView& view) noexcept {
    if (exchange.is_wanted.exchange(false)) {
        // Full if the status thread timed out: it requests again.
        [[maybe_unused]] const bool is_pushed = exchange.views.push(view());
    }
}

/// The status thread, until `is_ending`. The socket listens. No allocation.
/// @param why  null: the line has no distances
void serve_status(const StatusSocket& socket, const StatusLine& line, StatusExchange& exchange,
                  WhyDesk* why, const std::atomic<bool>& is_ending) noexcept;

}  // namespace axg
