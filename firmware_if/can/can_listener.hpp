// SPDX-License-Identifier: Apache-2.0
// A CAN interface for reading only: its socket has no function to send. The holder of a listener
// cannot send a frame on the bus; tests/style/watch_symbols.py checks that in the objects too.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "firmware_if/can/socket_can.hpp"

namespace axg {

class CanListener {
  public:
    /// Empty: `fault` has the failure and the next step.
    [[nodiscard]] static std::optional<CanListener> open(const SocketOptions& options,
                                                         std::string& fault);
    [[nodiscard]] ReadStatus read(CanArrival& out) noexcept { return wire_.read(out); }
    /// For poll(); readable when `read` has a result.
    [[nodiscard]] int descriptor() const noexcept { return wire_.descriptor(); }
    /// Frames dropped because the queue of this socket was full, since it was opened.
    [[nodiscard]] std::uint64_t frames_dropped() const noexcept { return wire_.frames_dropped(); }

  private:
    explicit CanListener(SocketCan wire) noexcept : wire_(std::move(wire)) {}
    SocketCan wire_;
};

}  // namespace axg
