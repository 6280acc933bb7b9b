// SPDX-License-Identifier: Apache-2.0
// One CAN frame with its time, as plain data; the same struct live and from a log.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

namespace axg {

struct CanFrame {
    std::int64_t time_us = 0;  // receive stamp; in a log the time written there
    std::uint32_t id = 0;      // 11 or 29 bits, without flags
    bool extended = false;
    bool remote = false;
    bool error = false;  // id then holds the error class bits of linux/can/error.h
    bool fd = false;
    bool bit_rate_switch = false;
    bool error_state = false;   // FD: sender is error-passive
    bool sent_by_host = false;  // direction T in a log, MSG_DONTROUTE live
    std::uint8_t raw_dlc = 0;   // 9..15 if a classical frame has that DLC, else 0
    std::uint8_t length_bytes = 0;
    std::array<std::uint8_t, 64> data{};
};
static_assert(std::is_trivially_copyable_v<CanFrame>);

}  // namespace axg
