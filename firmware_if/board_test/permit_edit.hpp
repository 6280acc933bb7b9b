// SPDX-License-Identifier: Apache-2.0
// A permit with one fault: what differs from the good one, and how its two frames are sent.
#pragma once

#include <array>
#include <cstdint>

#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {

enum class PairShape : std::uint8_t {
    pair,            // plain, then every bit inverted
    silence,         // nothing
    plain_only,      // no inverted frame
    inverted_first,  // the two in the wrong order
    one_bit,         // one bit is not inverted
    of_another,      // the inverted frame of the next permit
    late,            // the inverted frame more than T after the plain one
    interleaved,     // two senders: plain, plain, inverted, inverted
    short_frames,    // of 7 bytes
    again,           // the last good pair
};

/// Everything that is zero is as in a good permit.
struct PermitEdit {
    PairShape shape = PairShape::pair;
    std::uint32_t echo_back = 0;   // the sample so many before, with its own lap
    std::uint16_t lap_back = 0;    // the answer is for so many laps before
    bool is_former_nonce = false;  // the answer is for the session before
    std::uint32_t nonce_xor = 0;
    std::uint16_t answer_xor = 0;
    std::uint8_t word = 0;
    std::int32_t live_step = 1;     // from permit to permit
    std::int32_t samples = -1;      // n; below 0: as the machine file
    bool is_samples_above = false;  // n is one more than the machine file's
    std::uint8_t cap = kPermitCapNone, mask = 0, level = 0;
    bool is_too_late = false;  // sent when it has ended, and not before 10 ms
    // The edit is of the last permit of each `cycle`; the others are good. 1: of each.
    std::uint32_t cycle = 1;
    bool is_alone = false;  // the others are not sent
    bool is_once = false;   // one permit, then silence
    bool is_gap = false;    // until the board has to brake, and good ones then
};

/// Frames in order of time; `time_us` when each is due.
struct PairFrames {
    std::array<CanFrame, 4> frames{};
    std::uint32_t count = 0;
};

/// @param permit   with the fields of the edit already
/// @param now_us   when the first of them may leave
[[nodiscard]] PairFrames frames_of(const CanLayout& can, const Permit& permit, PairShape shape,
                                   std::int64_t now_us) noexcept;

/// The good permit with every field that the edit names; `permit` has echo, nonce and lap.
[[nodiscard]] Permit edited(const Permit& permit, const PermitEdit& edit) noexcept;

}  // namespace axg
