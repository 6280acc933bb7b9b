// SPDX-License-Identifier: Apache-2.0
// Frames of other makers: positions, speeds and states as runs of bits (CanSignal). Which bits:
// docs/reference/protocol.md; the receiver decides whether a frame may be used.
#pragma once

#include <cstdint>
#include <span>

#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

/// Reads every signal of frame `slot`, whose length was checked before. bad_format: an invalid tool
/// number.
[[nodiscard]] FrameStatus decode_signals(const AxisFrameSet& set, std::uint32_t slot,
                                         const CanFrame& frame, AxisFrameContent& out) noexcept;

/// Writes all frames of the set. A drive without fault reports "operation enabled".
/// @param last     the snapshot before, for speeds; without axes: at rest
/// @param counter  of snapshots; each counter signal sends it modulo its range
/// @return         the axis that does not fit (axis_count: the tool), or kNoIndex
[[nodiscard]] std::uint32_t fill_signals(const AxisFrameSet& set, const AxisSnapshot& snapshot,
                                         const AxisSnapshot& last, std::uint32_t counter,
                                         std::span<CanFrame> out) noexcept;

}  // namespace axg
