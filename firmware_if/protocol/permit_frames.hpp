// SPDX-License-Identifier: Apache-2.0
// The permit and the session frame that it refers to: the guard's side of docs/reference/board.md.
// The board's side is firmware_if/board.
#pragma once

#include <array>
#include <cstdint>

#include "core/guard/monitor.hpp"
#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

/// Any two of these differ in at least four bits; a zero byte is none of them.
enum class PermitWord : std::uint8_t { run = 0xA5, slow = 0xC3, jog = 0x3C, stop = 0x5A };

inline constexpr std::uint8_t kPermitCapNone = 250;    // 1/250 of rapid
inline constexpr std::uint8_t kPermitSamplesMax = 15;  // n has four bits

/// Session of a board's samples.
struct Session {
    std::uint32_t nonce = 0;        // 24 bits; new at power-up, and whenever a person arms
    std::uint16_t lap = 0;          // of that sample: +1 whenever SYNC begins again
    std::uint8_t sync_counter = 0;  // of the sample latched last
    std::uint8_t counter = 0;       // 0..15

    friend constexpr bool operator==(const Session&, const Session&) = default;
};

struct Permit {
    PermitWord word = PermitWord::stop;
    std::uint8_t sync_counter = 0;  // echo: the sample that was certified
    std::uint8_t live_counter = 0;
    std::uint16_t known_answer_signature = 0;
    std::uint8_t cap = kPermitCapNone;  // with the words run and slow
    std::uint8_t mask = 0;
    std::uint8_t samples = 0;  // n; 0 with the word stop
    std::uint8_t level = 0;    // 0..3, advice: clear, warn, slow, stop
    std::uint32_t nonce = 0;   // of the board's session
    std::uint16_t lap = 0;     // of the sample that was certified
};

/// The permit of a judged cycle, without session. Its word is stop without a permit, else jog in a
/// jog, else slow if a pair's clearance level is slow or worse, else run. For a board that promises
/// no cap, the speed cap is advice for all axes, and never hold.
[[nodiscard]] Permit permit_of(const CycleResult& result, std::uint8_t live_counter,
                               std::uint8_t sync_counter) noexcept;

/// The plain frame on layout.permit_id and its bit-inverted twin on the next id. Precondition:
/// samples <= 15, level <= 3, cap <= 250. With jog and stop, cap and mask are sent as none.
[[nodiscard]] std::array<CanFrame, 2> encode_permit(const CanLayout& layout, const Permit& permit,
                                                    std::int64_t time_us) noexcept;
/// The same with values that no guard sends, to test a board. Encodes the low four bits of samples.
/// Precondition: level <= 15.
[[nodiscard]] std::array<CanFrame, 2> encode_any_permit(const CanLayout& layout,
                                                        const Permit& permit,
                                                        std::int64_t time_us) noexcept;

/// For simulated boards. Precondition: nonce and counter fit their fields.
[[nodiscard]] CanFrame encode_session(std::uint32_t id, const Session& session,
                                      std::int64_t time_us) noexcept;

/// Reads a session frame with this id, which is its Data ID too. bad_format: flexible, or sealed
/// with another version or a SYNC counter that does not exist; `out` is untouched unless ok.
[[nodiscard]] FrameStatus decode_session(std::uint32_t id, const CanFrame& frame,
                                         Session& out) noexcept;

}  // namespace axg
