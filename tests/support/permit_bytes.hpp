// SPDX-License-Identifier: Apache-2.0
// Permits as a board on the bench reads them: without a judgement (bench_board.hpp).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/permit_frames.hpp"

namespace axg::test {

[[nodiscard]] inline CanFrame inverse_of(const CanFrame& plain) {
    CanFrame out = plain;
    ++out.id;
    for (std::size_t i = 0; i < 8; ++i) {
        out.data[i] = static_cast<std::uint8_t>(~plain.data[i]);
    }
    return out;
}

/// All but nonce and lap, which no byte tells.
[[nodiscard]] inline Permit read(const CanFrame& plain) {
    const auto& data = plain.data;
    return {.word = static_cast<PermitWord>(data[0]),
            .sync_counter = data[1],
            .live_counter = data[2],
            .known_answer_signature = 0xC5A3,
            .cap = data[5],
            .mask = data[6],
            .samples = static_cast<std::uint8_t>(data[7] >> 4U),
            .level = static_cast<std::uint8_t>(data[7] & 15U)};
}

}  // namespace axg::test
