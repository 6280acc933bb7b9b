// SPDX-License-Identifier: Apache-2.0
// The session frame of a board whose samples are counted from lap 0 on, made without the code under
// test.
#pragma once

#include <cstdint>
#include <span>

#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/e2e.hpp"

namespace axg::test {

struct SessionSays {
    std::uint64_t number = 0;  // of the sample latched last
    std::uint32_t nonce = 0xC0FFEE;
    std::uint8_t counter = 0;
};

inline CanFrame session_frame(const SessionSays& says, std::int64_t time_us,
                              std::uint32_t id = 0x583) {
    CanFrame frame;
    frame.id = id;
    frame.length_bytes = 8;
    frame.time_us = time_us;
    const std::uint64_t lap = says.number / kSyncCounterMax;
    const auto byte = [](std::uint64_t value, unsigned index) {
        return static_cast<std::uint8_t>(value >> 8U * index);
    };
    frame.data[1] = static_cast<std::uint8_t>(0x10U | (says.counter & 15U));
    frame.data[2] = sync_counter_of(says.number);
    frame.data[3] = byte(lap, 0);
    frame.data[4] = byte(lap, 1);
    for (unsigned i = 0; i < 3; ++i) {
        frame.data[5 + i] = byte(says.nonce, i);
    }
    frame.data[0] = classical_crc(std::span<const std::uint8_t, 8>(frame.data.data(), 8),
                                  static_cast<std::uint16_t>(id));
    return frame;
}

}  // namespace axg::test
