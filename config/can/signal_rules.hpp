// SPDX-License-Identifier: Apache-2.0
// Rules for every signal, whichever file describes it: units, bits inside the frame, and enough of
// them for the travel.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/machine/machine.hpp"

namespace axg {

inline constexpr std::uint32_t kFrameBitsMax = 512;
inline constexpr std::uint32_t kExactBitsMax = 53;  // of an integer: a double holds no more
using FrameBits = std::bitset<kFrameBitsMax>;

inline constexpr std::array<std::string_view, 7> kSignalUnitNames{"mm",  "inch", "m",   "um",
                                                                  "deg", "rad",  "turn"};
struct SignalUnit {
    AxisKind kind;
    double factor;  // to mm or degrees
};
/// @param index  into kSignalUnitNames
[[nodiscard]] SignalUnit signal_unit(std::size_t index) noexcept;
/// The names for one kind of axis, as a wish: "deg, rad or turn".
[[nodiscard]] std::string units_of(AxisKind kind);

/// The bits a signal covers, numbered as in CanSignal. False when one is outside the frame.
[[nodiscard]] bool covered_bits(const CanSignal& signal, std::uint32_t frame_bits, FrameBits& out);

/// Whether the bits of a signal, in mm or degrees, can represent every position of the travel.
struct SignalReach {
    bool fits = true;
    std::string got, wanted;
};
[[nodiscard]] SignalReach reach_of(const CanSignal& signal, const Axis& axis);

}  // namespace axg
