// SPDX-License-Identifier: Apache-2.0
// State of a CAN interface that the kernel reports only over rtnetlink: bit rates, controller
// modes, state, error counters. Source: linux/can/netlink.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace axg {

struct CanLink {
    std::string kind;                             // "can": a controller; "vcan", "vxcan": virtual
    std::uint32_t bitrate = 0, data_bitrate = 0;  // bit/s; 0: none set
    std::uint32_t restart_ms = 0;
    std::uint32_t modes = 0;  // CAN_CTRLMODE_*
    std::uint32_t state = 0;  // enum can_state
    std::uint16_t tx_errors = 0, rx_errors = 0;
    bool has_counters = false;
    std::uint32_t bus_offs = 0, passives = 0, restarts = 0;  // since the interface was made
};

/// One RTM_NEWLINK message, header included. False: it is none, or cut short.
[[nodiscard]] bool parse_can_link(std::span<const std::byte> message, CanLink& out);

/// Empty: the reason is in `fault`.
[[nodiscard]] std::optional<CanLink> request_can_link(const std::string& bus, std::string& fault);

}  // namespace axg
