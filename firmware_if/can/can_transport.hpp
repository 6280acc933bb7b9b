// SPDX-License-Identifier: Apache-2.0
// The wire as the live guard sees it: frames in and out, never waiting. The one interface with
// virtual functions in the cycle, so that a wire with faults can replace a socket in tests.
#pragma once

#include <cstdint>

#include "firmware_if/can/can_frame.hpp"

namespace axg {

enum class SendStatus : std::uint8_t {
    failed = 0,  // for an unexpected reason
    ok,          // the kernel accepted it; only its echo proves that it was on the wire
    busy,        // the queue is full: try again later
    down,        // the interface is down
    gone,        // the interface was removed
};

enum class ReadStatus : std::uint8_t { failed = 0, none, frame, down, gone };
[[nodiscard]] const char* to_text(SendStatus status) noexcept;
[[nodiscard]] const char* to_text(ReadStatus status) noexcept;

struct CanArrival {
    CanFrame frame;                // time_us: monotonic clock, never later than the arrival
    bool is_own = false;           // the echo of a frame that this transport sent
    std::int64_t hardware_ns = 0;  // the controller's stamp, on a clock of its own; 0: none
};

class CanTransport {
  public:
    virtual ~CanTransport() = default;
    /// At most one system call; never waits.
    [[nodiscard]] virtual SendStatus send(const CanFrame& frame) noexcept = 0;
    /// The next frame, if there is one. `down` and `gone` are reported once each.
    [[nodiscard]] virtual ReadStatus read(CanArrival& out) noexcept = 0;
};

}  // namespace axg
