// SPDX-License-Identifier: Apache-2.0
// Frames of the guard as a display reads them: shape, checksum and ranges, no age and no order. A
// board judges permits by its own rules (firmware_if/board). Bytes: docs/reference/board.md.
#pragma once

#include <cstdint>
#include <optional>

#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "firmware_if/protocol/operator_frames.hpp"
#include "firmware_if/protocol/permit_frames.hpp"

namespace axg {

/// A pair of frames with a permit.
struct SeenPermit {
    Permit permit;  // nonce and lap are 0: the CRC covers them, no byte shows them
    std::uint16_t answer = 0;
};
/// Empty: no pair, or values that no guard sends.
[[nodiscard]] std::optional<SeenPermit> read_permit(const CanLayout& layout, const CanFrame& plain,
                                                    const CanFrame& twin) noexcept;
/// Bytes 3 and 4 of a correct permit with this nonce and lap.
[[nodiscard]] std::uint16_t answer_of(const CanLayout& layout, const Permit& permit) noexcept;

[[nodiscard]] std::optional<Hints> read_hints(const CanLayout& layout,
                                              const CanFrame& frame) noexcept;

[[nodiscard]] std::optional<OperatorStatus> read_operator_status(const CanLayout& layout,
                                                                 const CanFrame& frame) noexcept;

}  // namespace axg
