// SPDX-License-Identifier: Apache-2.0
// Which frames of the bus the live guard reads, and which are its own.
#pragma once

#include <cstdint>
#include <span>

#include "core/machine/machine.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

inline constexpr std::uint32_t kLiveIdsMax = kFramesPerSnapshotMax + 10 + kAxesMax;
/// Every id that the guard reads, its own for their echo included.
/// @return  how many; `out` needs room for kLiveIdsMax
[[nodiscard]] std::uint32_t live_ids(const Machine& machine, std::span<std::uint32_t> out) noexcept;
/// Of a frame that no other node may send; the stop is not among them, for anybody may stop.
[[nodiscard]] bool is_guard_id(const CanLayout& can, std::uint32_t id) noexcept;
/// Whatever its length and format, as a board obeys it.
[[nodiscard]] bool is_stop_frame(const CanLayout& can, const CanFrame& frame) noexcept;

}  // namespace axg
