// SPDX-License-Identifier: Apache-2.0
// The clock of a CAN socket: CLOCK_MONOTONIC, and a sleep that a frame ends.
#pragma once

#include "firmware_if/can/socket_can.hpp"
#include "hil_replay/board/live_loop.hpp"

namespace axg {

/// `wire` must outlive it.
[[nodiscard]] LiveClock socket_clock(const SocketCan& wire);

}  // namespace axg
