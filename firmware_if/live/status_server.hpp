// SPDX-License-Identifier: Apache-2.0
// The status thread: for each client it requests a copy of the bus thread's state and sends it as a
// line; and it logs what leads out of a stop. Neither can slow the bus thread down, however many
// the clients: it reads one flag a turn, and copies at most once in kViewWaitMs.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "firmware_if/explain/stop_desk.hpp"
#include "firmware_if/live/live_view.hpp"
#include "firmware_if/live/status_line.hpp"
#include "firmware_if/system/status_socket.hpp"

namespace axg {

inline constexpr int kViewWaitMs = 20;
inline constexpr int kViewTries = 10;  // then the last view is served, with its age

/// Prints the sentences of a stop on stderr: at the stop, and once more at rest, where a way out
/// may be known. The log of phases has the first, the cause.
class StopLog {
  public:
    void note(const LiveView& view, const StopAccount& account);

  private:
    std::int64_t stop_us_ = -1;  // of the stop that it has logged; -1: none
    bool was_confirmed_ = false;
    std::size_t printed_ = 0;
};

struct StatusService {
    const StatusSocket* socket = nullptr;  // listens; null: no clients
    const StatusLine* line = nullptr;
    StopDesk* desk = nullptr;  // null: the line has neither distances nor a way out
    StopLog* log = nullptr;    // null: stops are not logged
};

/// The status thread, until `is_ending`. Allocates only in a stop.
void serve_status(const StatusService& service, ViewExchange& exchange,
                  const std::atomic<bool>& is_ending) noexcept;

}  // namespace axg
