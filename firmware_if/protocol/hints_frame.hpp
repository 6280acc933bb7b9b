// SPDX-License-Identifier: Apache-2.0
// Frame for a display every 10 ms: the pair that is nearest to its margin, and its proven
// distance. Advice without a checksum, of the lowest rank: no proof and no board depends on it.
// Bytes: docs/reference/board.md, "Hints".
#pragma once

#include <cstdint>

#include "core/guard/monitor.hpp"
#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"

namespace axg {

inline constexpr std::uint16_t kHintNone = 0xFFFF;  // no pair; of a distance: as much or more

struct Hints {
    std::uint8_t sync_counter = 0;    // the sample that they are of
    std::uint16_t pair = kHintNone;   // Machine::pairs, which
    std::uint16_t distance_10um = 0;  // lower bound, rounded down
};

/// Hints of a cycle. Without a permit: the pair that is not proven, and distance 0.
[[nodiscard]] Hints hints_of(const CycleResult& result, std::uint8_t sync_counter) noexcept;

/// Five bytes on layout.hints_id.
[[nodiscard]] CanFrame encode_hints(const CanLayout& layout, const Hints& hints,
                                    std::int64_t time_us) noexcept;

}  // namespace axg
