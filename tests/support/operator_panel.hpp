// SPDX-License-Identifier: Apache-2.0
// A control panel made of the board's library: what it sends, and what it reads of the guard.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware_if/board/axguard_operator.h"
#include "firmware_if/can/can_frame.hpp"

namespace axg::test {

inline constexpr axg_board_axis_ids kOperatorIn{.id = 0x584, .data_id = 0x584};
inline constexpr axg_board_axis_ids kOperatorOut{.id = 0x604, .data_id = 0x604};

inline CanFrame frame_of(const axg_board_can_frame& made, std::int64_t time_us) {
    CanFrame frame;
    frame.id = made.id;
    frame.fd = made.is_fd;
    frame.length_bytes = made.length;
    frame.time_us = time_us;
    std::copy_n(made.data, made.length, frame.data.begin());
    return frame;
}

inline CanFrame operator_frame(const axg_operator_message& message, std::int64_t time_us) {
    axg_board_can_frame made{};
    axg_operator_encode(&message, kOperatorIn, &made);
    return frame_of(made, time_us);
}

inline std::optional<axg_operator_status> status_in(const CanFrame& frame) {
    axg_board_can_frame read{};
    read.id = frame.id;
    read.is_fd = frame.fd;
    read.length = frame.length_bytes;
    std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length_bytes, 8), read.data);
    axg_operator_status status{};
    return axg_operator_decode_status(&read, kOperatorOut, &status) ? std::optional(status)
                                                                    : std::nullopt;
}

struct OperatorPanel {
    std::uint8_t counter = 7;  // of the next message

    CanFrame request(axg_operator_action action, std::int64_t time_us) {
        return next(action, AXG_OPERATOR_REQUEST, 0, time_us);
    }
    CanFrame confirm(axg_operator_action action, std::uint32_t nonce, std::int64_t time_us) {
        return next(action, AXG_OPERATOR_CONFIRM, nonce, time_us);
    }
    CanFrame next(axg_operator_action action, axg_operator_step step, std::uint32_t nonce,
                  std::int64_t time_us) {
        const axg_operator_message message{
            .action = action, .step = step, .stands = false, .counter = counter, .nonce = nonce};
        counter = (counter + 1) & 15U;
        return operator_frame(message, time_us);
    }
};

}  // namespace axg::test
