// SPDX-License-Identifier: Apache-2.0
// Ids of the frames that the live guard reads, and of those that only it sends.
#pragma once

#include <cstdint>
#include <span>

#include "core/machine/frame_ids.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

// Beside the rows of kFrameIds: the look-ahead path, and the permit's second id.
inline constexpr std::uint32_t kLiveIdsMax =
    kFramesPerSnapshotMax + static_cast<std::uint32_t>(kFrameIds.size()) + 2 + kAxesMax;
/// Writes every id that the guard reads, including its own ids for their echo.
/// @return  how many; `out` needs room for kLiveIdsMax
[[nodiscard]] std::uint32_t live_ids(const Machine& machine, std::span<std::uint32_t> out) noexcept;
/// Whether only the guard may send this id. False for the stop, which every node may send.
[[nodiscard]] bool is_guard_id(const CanLayout& can, std::uint32_t id) noexcept;
/// True for every length and format, as a board obeys it.
[[nodiscard]] bool is_stop_frame(const CanLayout& can, const CanFrame& frame) noexcept;

}  // namespace axg
