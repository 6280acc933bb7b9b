// SPDX-License-Identifier: Apache-2.0
// One coherent snapshot of all axes: every value was latched by the board at the same instant.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/base/limits.hpp"

namespace axg {

// Modes a board reports (AxisSnapshot::mode), and flags; the bytes on the wire:
// docs/reference/protocol.md.
inline constexpr std::uint8_t kModeStandstill = 0;  // all axes held in place
inline constexpr std::uint8_t kModeMoving = 1;      // positions bit-equal for long are then a fault
inline constexpr std::uint8_t kModeToolChange = 2;  // `tool` may change
inline constexpr std::uint8_t kModeJog = 3;         // one axis may move, one way: see the flags
inline constexpr std::uint8_t kFlagNotHomed = 0x01;     // positions have no reference: never used
inline constexpr std::uint8_t kFlagJogNegative = 0x02;  // mode jog: towards smaller positions
inline constexpr unsigned kJogAxisShift = 4;            // mode jog: its axis in bits 4 to 7
inline constexpr std::uint8_t kFlagAck = 0x04;          // any other mode: bits 4 to 7 are an ack
inline constexpr unsigned kAckShift = 4;

struct AxisSnapshot {
    std::int64_t latched_us = 0;  // instant of the sample, receiver's clock (or estimated)
    std::int64_t arrived_us = 0;  // arrival of the last frame of the set
    std::uint64_t sample = 0;     // index of the sample since the first one seen, gaps counted
    std::uint32_t axis_count = 0;
    std::uint16_t tool = 0;  // tool number the board reports
    std::uint8_t mode = 0;   // one of kMode..., docs/reference/protocol.md
    std::uint8_t flags = 0;
    std::array<double, kAxesMax> position{};  // mm or rad, in Machine::axes order
};
static_assert(std::is_trivially_copyable_v<AxisSnapshot>);

/// Why a snapshot is not a base for proofs.
enum class SnapshotStatus : std::uint8_t {
    not_run = 0,
    ok,
    wrong_axes,
    not_finite,
    unknown_tool,
    left_path,    // the axes are not at the announced positions, or the board changed these
    left_jog,     // another axis moved; or the jog's axis moved back or too fast, or is unknown
    left_travel,  // outside the travel of the travel proofs, overrun included
    left_limits,  // an axis broke a declared limit (core/reach/limit_evidence.hpp)
    own_stop,     // only a stop of the board's own explains the motion of an axis
};

/// Low four bits of the live counter of the permit whose cap the board obeys; empty: none is named.
/// No proof uses it yet. Source: docs/reference/board.md, "Samples and the flags byte".
[[nodiscard]] constexpr std::optional<std::uint8_t> acked_permit(
    const AxisSnapshot& snapshot) noexcept {
    if (snapshot.mode == kModeJog || (snapshot.flags & kFlagAck) == 0) {
        return std::nullopt;
    }
    return static_cast<std::uint8_t>(snapshot.flags >> kAckShift);
}

}  // namespace axg
