// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/can_link.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace axg {
namespace {

constexpr std::size_t kAlign = 4;

std::size_t aligned(std::size_t size) noexcept {
    return (size + kAlign - 1) / kAlign * kAlign;
}

/// The front of `bytes` as a Header; zeros where it is cut short.
template <class Header>
Header front(std::span<const std::byte> bytes) noexcept {
    Header header{};
    std::memcpy(&header, bytes.data(), std::min(bytes.size(), sizeof header));
    return header;
}

/// Calls the function with (type, payload) for each attribute. False: one is cut short.
template <class Take>
bool for_each_attribute(std::span<const std::byte> bytes, Take&& take) {
    while (bytes.size() >= sizeof(rtattr)) {
        const auto head = front<rtattr>(bytes);
        if (head.rta_len < sizeof head || head.rta_len > bytes.size()) {
            return false;
        }
        take(head.rta_type & NLA_TYPE_MASK, bytes.subspan(sizeof head, head.rta_len - sizeof head));
        bytes = bytes.subspan(std::min(aligned(head.rta_len), bytes.size()));
    }
    return true;
}

bool take_data(std::span<const std::byte> data, CanLink& out) {
    return for_each_attribute(data, [&out](int type, std::span<const std::byte> value) {
        switch (type) {
            case IFLA_CAN_BITTIMING:
                out.bitrate = front<can_bittiming>(value).bitrate;
                break;
            case IFLA_CAN_DATA_BITTIMING:
                out.data_bitrate = front<can_bittiming>(value).bitrate;
                break;
            case IFLA_CAN_STATE:
                out.state = front<std::uint32_t>(value);
                break;
            case IFLA_CAN_CTRLMODE:
                out.modes = front<can_ctrlmode>(value).flags;
                break;
            case IFLA_CAN_RESTART_MS:
                out.restart_ms = front<std::uint32_t>(value);
                break;
            case IFLA_CAN_BERR_COUNTER:
                out.tx_errors = front<can_berr_counter>(value).txerr;
                out.rx_errors = front<can_berr_counter>(value).rxerr;
                out.has_counters = true;
                break;
            default:
                break;
        }
    });
}

bool take_info(std::span<const std::byte> info, CanLink& out) {
    bool is_whole = true;
    const bool is_read = for_each_attribute(info, [&](int type, std::span<const std::byte> value) {
        if (type == IFLA_INFO_KIND) {
            const char* const text = reinterpret_cast<const char*>(value.data());
            out.kind.assign(text, strnlen(text, value.size()));
        } else if (type == IFLA_INFO_DATA) {
            is_whole = is_whole && take_data(value, out);
        } else if (type == IFLA_INFO_XSTATS) {
            const auto counts = front<can_device_stats>(value);
            out.bus_offs = counts.bus_off;
            out.passives = counts.error_passive;
            out.restarts = counts.restarts;
        }
    });
    return is_read && is_whole;
}

}  // namespace

bool parse_can_link(std::span<const std::byte> message, CanLink& out) {
    const auto head = front<nlmsghdr>(message);
    constexpr std::size_t kHeads = sizeof(nlmsghdr) + sizeof(ifinfomsg);
    if (head.nlmsg_type != RTM_NEWLINK || head.nlmsg_len < kHeads ||
        head.nlmsg_len > message.size()) {
        return false;
    }
    CanLink link;
    bool is_whole = true;
    const bool is_read = for_each_attribute(message.first(head.nlmsg_len).subspan(kHeads),
                                            [&](int type, std::span<const std::byte> value) {
                                                if (type == IFLA_LINKINFO) {
                                                    is_whole = is_whole && take_info(value, link);
                                                }
                                            });
    if (!is_read || !is_whole) {
        return false;
    }
    out = link;
    return true;
}

std::optional<CanLink> request_can_link(const std::string& bus, std::string& fault) {
    struct {
        nlmsghdr head;
        ifinfomsg link;
    } request{};
    request.head.nlmsg_len = sizeof request;
    request.head.nlmsg_type = RTM_GETLINK;
    request.head.nlmsg_flags = NLM_F_REQUEST;
    request.link.ifi_index = static_cast<int>(if_nametoindex(bus.c_str()));
    const int socket = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    const timeval patience{.tv_sec = 2, .tv_usec = 0};
    std::array<std::byte, 16384> reply{};
    ssize_t size = -1;
    if (socket >= 0 &&
        setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0 &&
        ::send(socket, &request, sizeof request, 0) == sizeof request) {
        size = recv(socket, reply.data(), reply.size(), 0);
    }
    fault = size < 0 ? std::strerror(errno) : "a reply that is not a link";
    if (socket >= 0) {
        close(socket);
    }
    CanLink link;
    if (size < 0 || !parse_can_link({reply.data(), static_cast<std::size_t>(size)}, link)) {
        return std::nullopt;
    }
    return link;
}

}  // namespace axg
