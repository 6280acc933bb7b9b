// SPDX-License-Identifier: Apache-2.0
// Frames of eight bytes whose first is a checksum over the others and their id: the session and the
// operator's. Source: docs/reference/board.md, "Frames".
#pragma once

#include <span>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/e2e.hpp"

namespace axg::detail {

inline constexpr std::uint8_t kSealedBytes = 8;

/// The Data ID is the id.
[[nodiscard]] inline std::uint8_t seal_of(const CanFrame& frame) noexcept {
    return classical_crc(
        std::span<const std::uint8_t, kSealedBytes>(frame.data.data(), kSealedBytes),
        static_cast<std::uint16_t>(frame.id));
}

/// Whether it is a frame with this id, whole. bad_format: flexible.
[[nodiscard]] inline FrameStatus check_sealed(std::uint32_t id, const CanFrame& frame) noexcept {
    if (frame.error || frame.extended || frame.remote || frame.id != id) {
        return FrameStatus::not_ours;
    }
    if (frame.fd) {
        return FrameStatus::bad_format;
    }
    if (frame.raw_dlc != 0) {
        return FrameStatus::raw_dlc;
    }
    if (frame.length_bytes != kSealedBytes) {
        return FrameStatus::bad_length;
    }
    return frame.data[0] == seal_of(frame) ? FrameStatus::ok : FrameStatus::bad_crc;
}

}  // namespace axg::detail
