// SPDX-License-Identifier: Apache-2.0
// A person's reset and arm by frames: the message of a control panel, and the guard's status in
// reply. The panel's side is firmware_if/board/axguard_operator.h. Bytes:
// docs/reference/board.md, "An operator's reset and arm".
#pragma once

#include <cstdint>

#include "core/guard/guard_state.hpp"
#include "core/machine/can_layout.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

enum class OperatorAction : std::uint8_t { none = 0, reset = 0x96, arm = 0x69 };
enum class OperatorStep : std::uint8_t { request = 0x0F, confirm = 0xF0 };

enum class OperatorRefusal : std::uint8_t {
    none = 0,
    moves,     // an axis moves, or is not proven to be at rest
    cause,     // the cause of the stop is still present
    phase,     // nothing to reset or to arm in this phase
    nonce,     // a confirmation of another request, or of none
    too_late,  // confirmed more than 5 s after the request
    board,     // the board stopped by itself, and nobody armed it since
};
inline constexpr std::uint32_t kOperatorRefusals = 7;

struct OperatorMessage {
    OperatorAction action = OperatorAction::none;
    OperatorStep step = OperatorStep::request;
    bool stands = false;       // a person sees all axes at rest: only with format signals
    std::uint8_t counter = 0;  // 4 bits
    std::uint32_t nonce = 0;   // 24 bits, of the status; 0 in a request
};

struct OperatorStatus {
    GuardPhase phase = GuardPhase::stopped;
    OperatorAction action = OperatorAction::none;  // waits for its confirmation
    OperatorRefusal refusal = OperatorRefusal::none;
    std::uint8_t counter = 0;
    std::uint32_t nonce = 0;  // to be repeated; 0: nothing waits
};

/// Eight bytes on layout.operator_out_id.
[[nodiscard]] CanFrame encode_operator_status(const CanLayout& layout, const OperatorStatus& status,
                                              std::int64_t time_us) noexcept;
/// @param out  untouched unless ok
[[nodiscard]] FrameStatus decode_operator_message(const CanLayout& layout, const CanFrame& frame,
                                                  OperatorMessage& out) noexcept;

}  // namespace axg
