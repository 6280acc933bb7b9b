// SPDX-License-Identifier: Apache-2.0
// Frames of the guard: the permit and its inverted twin, the stop, the emergency message, the
// heartbeat. Also a strict reader of them, like that of a board, for tests and for traces.
// Bytes: docs/reference/protocol.md.
#pragma once

#include <array>
#include <cstdint>

#include "core/guard/guard_state.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/e2e.hpp"

namespace axg {

/// Any two of these differ in at least four bits; a zero byte is none of them.
enum class PermitWord : std::uint8_t { run = 0xA5, slow = 0xC3, jog = 0x3C, stop = 0x5A };

inline constexpr std::uint16_t kClearanceDmmMax = 0xFF;  // the byte of the permit, 0.1 mm

struct Permit {
    PermitWord word = PermitWord::stop;
    std::uint8_t sync_counter = 0;  // echo: the sample that was certified
    std::uint8_t live_counter = 0;  // one more with each permit, 255 -> 0
    std::uint16_t known_answer_signature = 0;
    std::uint8_t speed_cap = 0;      // 1/250 of rapid; an advisory
    std::uint8_t pair = 0;           // of least clearance; 255: 255 or above
    std::uint8_t clearance_dmm = 0;  // lower bound, 0.1 mm, rounded down; 255: at least 25.5 mm

    friend constexpr bool operator==(const Permit&, const Permit&) = default;
};

/// The permit of a judged cycle. Its word is stop without a permit, else jog in a jog, else slow
/// if a pair's clearance level is slow or worse, else run.
[[nodiscard]] Permit permit_of(const CycleResult& result, std::uint8_t live_counter,
                               std::uint8_t sync_counter) noexcept;

/// A clearance in mm as the permit carries it: rounded down, 0 for anything that is no positive
/// number.
[[nodiscard]] std::uint8_t permit_clearance(double clearance_mm) noexcept;

/// The plain frame on layout.permit_id and its bit-inverted twin on the next id.
[[nodiscard]] std::array<CanFrame, 2> encode_permit(const CanLayout& layout, const Permit& permit,
                                                    std::int64_t time_us) noexcept;

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

enum class PermitFault : std::uint8_t {
    none,
    bad_shape,     // of either frame
    twin_missing,  // two plain frames in a row
    twin_alone,    // an inverted frame without the plain one before it
    twin_late,     // more than SRVT after the plain one
    twin_differs,  // not the plain one with every bit turned
    bad_word,
    live_counter,  // did not advance by one to three
    period,        // the last pair is older than SCT
};
[[nodiscard]] const char* to_text(PermitFault fault) noexcept;

struct PermitTimes {
    std::int64_t period_max_us = 4000;  // SCT: from pair to pair
    std::int64_t twin_max_us = 2000;    // SRVT: from plain to inverted
};

/// Judges the permit frames of a trace as the board must. Starts without a permit; any fault is a
/// stop.
class PermitChecker {
  public:
    explicit PermitChecker(const CanLayout& layout, PermitTimes times = {}) noexcept;

    struct Result {
        bool is_permit = false;  // a complete good pair: `permit` holds it
        PermitFault fault = PermitFault::none;
        Permit permit;
    };
    [[nodiscard]] Result on_frame(const CanFrame& frame) noexcept;
    /// Silence: the fault `period`, once, when the last good pair is older than SCT.
    [[nodiscard]] Result on_time(std::int64_t now_us) noexcept;

  private:
    std::uint32_t id_ = 0;
    PermitTimes times_;
    SequenceCheck live_;
    CanFrame plain_;
    bool has_plain_ = false;
    bool has_pair_ = false;
    std::int64_t pair_us_ = 0;
};

}  // namespace axg
