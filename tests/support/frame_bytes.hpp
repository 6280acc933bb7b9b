// SPDX-License-Identifier: Apache-2.0
// The data of a CAN frame, as tests compare it: as bytes, and in hex as the vectors write it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "firmware_if/can/can_frame.hpp"

namespace axg::test {

inline std::vector<std::uint8_t> bytes_of(const CanFrame& frame) {
    return {frame.data.begin(), frame.data.begin() + frame.length_bytes};
}

inline std::string hex_of(const CanFrame& frame) {
    std::string text;
    for (const std::uint8_t byte : bytes_of(frame)) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02X", byte);
        text += digits;
    }
    return text;
}

}  // namespace axg::test
