// SPDX-License-Identifier: Apache-2.0
// Frames of the guard beside the permit: the stop, quick stops, the emergency message, the
// heartbeat; and their reader, for tests and for traces. Bytes: docs/reference/protocol.md.
#pragma once

#include <cstdint>

#include "core/guard/guard_state.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"

namespace axg {

/// The global fail-safe command: no payload. Sent first, and each period until it is confirmed.
[[nodiscard]] CanFrame encode_stop(const CanLayout& layout, std::int64_t time_us) noexcept;

/// To a CiA 402 drive: the command quick stop, a control word (object 0x6040) with bit 1 set and
/// bit 2 clear.
[[nodiscard]] CanFrame encode_quick_stop(std::uint32_t id, std::int64_t time_us) noexcept;

enum class EmergencyCode : std::uint16_t {
    reset = 0x0000,  // the cause is gone and acknowledged
    bus = 0x8100,
    predicted_collision = 0xFF01,
    contact = 0xFF02,
    deadline = 0xFF03,
    known_answer = 0xFF04,
    input_stale = 0xFF05,
    model_hash = 0xFF06,
};
[[nodiscard]] const char* to_text(EmergencyCode code) noexcept;

/// Stop information for the board; `reason` is used if the cause is a verdict.
[[nodiscard]] EmergencyCode emergency_code_of(GuardFault cause, StopReason reason) noexcept;

struct Emergency {
    EmergencyCode code = EmergencyCode::reset;
    std::uint8_t error_register = 0;  // object 0x1001; bit 0: any error
    std::uint8_t pair = 0;            // 255: none, or 255 and above
    std::int16_t clearance_10um = 0;
    std::uint16_t time_to_contact_100us = 0;

    friend constexpr bool operator==(const Emergency&, const Emergency&) = default;
};

/// Information only, on layout.emergency_id. The stop never depends on it.
[[nodiscard]] CanFrame encode_emergency(const CanLayout& layout, const Emergency& emergency,
                                        std::int64_t time_us) noexcept;
/// A number of 10 um or 100 us as the message carries it: nearest, clamped to its field.
[[nodiscard]] std::int16_t emergency_clearance(double clearance_mm) noexcept;
[[nodiscard]] std::uint16_t emergency_time(double time_s) noexcept;

[[nodiscard]] CanFrame encode_guard_heartbeat(const CanLayout& layout, GuardHeartbeat heartbeat,
                                              std::int64_t time_us) noexcept;

enum class GuardFrameStatus : std::uint8_t {
    ok,         // read
    not_ours,   // another id, or extended, or an error frame: not judged
    bad_shape,  // flexible, extended, remote, an error frame, or another length
    bad_word,   // no permit word, or a value that is reserved
};
[[nodiscard]] GuardFrameStatus decode_emergency(const CanLayout& layout, const CanFrame& frame,
                                                Emergency& out) noexcept;
[[nodiscard]] GuardFrameStatus decode_stop(const CanLayout& layout, const CanFrame& frame) noexcept;
[[nodiscard]] GuardFrameStatus decode_guard_heartbeat(const CanLayout& layout,
                                                      const CanFrame& frame,
                                                      GuardHeartbeat& out) noexcept;

}  // namespace axg
