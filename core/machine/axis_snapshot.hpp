// SPDX-License-Identifier: Apache-2.0
// One coherent snapshot of all axes: every value was latched by the board at the same instant.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/base/limits.hpp"

namespace axg {

// Modes a board reports (AxisSnapshot::mode), and flags; the bytes on the wire: docs/protocol.md.
inline constexpr std::uint8_t kModeStandstill = 0;  // all axes held in place
inline constexpr std::uint8_t kModeMoving = 1;      // positions bit-equal for long are then a fault
inline constexpr std::uint8_t kModeToolChange = 2;  // `tool` may change
inline constexpr std::uint8_t kModeJog = 3;         // one axis may move, one way, as the flags say
inline constexpr std::uint8_t kFlagNotHomed = 0x01;     // positions have no reference: never used
inline constexpr std::uint8_t kFlagJogNegative = 0x02;  // mode jog: towards smaller positions
inline constexpr unsigned kJogAxisShift = 4;            // mode jog: its axis in bits 4 to 7

struct AxisSnapshot {
    std::int64_t latched_us = 0;  // instant of the sample, receiver's clock (or estimated)
    std::int64_t arrived_us = 0;  // arrival of the last frame of the set
    std::uint64_t sample = 0;     // index of the sample since the first one seen, gaps counted
    std::uint32_t axis_count = 0;
    std::uint16_t tool = 0;  // tool number the board reports
    std::uint8_t mode = 0;   // kModeMoving and its kin, docs/protocol.md
    std::uint8_t flags = 0;
    std::array<double, kAxesMax> position{};  // mm or rad, in Machine::axes order
};
static_assert(std::is_trivially_copyable_v<AxisSnapshot>);

}  // namespace axg
