// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "hil_replay/watch/http_server.hpp"

namespace axg {
namespace {

constexpr std::size_t kHostBytesMax = 64;

bool is_ipv4(const std::string& text, in_addr& out) {
    return inet_pton(AF_INET, text.c_str(), &out) == 1;
}
bool is_ipv6(const std::string& text, in6_addr& out) {
    return inet_pton(AF_INET6, text.c_str(), &out) == 1;
}

/// Host and port of "HOST:PORT" or "[HOST]:PORT"; without ":PORT" the port is empty. False: the
/// brackets do not match, or a character does not belong there.
bool split_host(std::string_view text, std::string& host, std::string_view& port) {
    if (text.size() > kHostBytesMax) {
        return false;
    }
    std::size_t end = 0;
    if (text.starts_with('[')) {
        end = text.find(']');
        if (end == std::string_view::npos) {
            return false;
        }
        host = text.substr(1, end - 1);
        ++end;
    } else {
        end = std::min(text.find(':'), text.size());
        host = text.substr(0, end);
    }
    const std::string_view rest = text.substr(end);
    if (!rest.empty() && rest.front() != ':') {
        return false;
    }
    port = rest.empty() ? rest : rest.substr(1);
    return std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::optional<ListenAddress> read_listen_address(std::string_view text) {
    ListenAddress out;
    std::string_view port;
    if (!split_host(text, out.host, port) || port.empty()) {
        return std::nullopt;
    }
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), out.port);
    if (error != std::errc() || end != port.data() + port.size()) {
        return std::nullopt;
    }
    if (out.host == "localhost") {
        out.host = "127.0.0.1";
    }
    in_addr v4{};
    in6_addr v6{};
    constexpr std::uint32_t kLoopbackNet = 127;
    if (!text.starts_with('[') && is_ipv4(out.host, v4)) {
        out.is_loopback = ntohl(v4.s_addr) >> 24U == kLoopbackNet;
        return out;
    }
    if (text.starts_with('[') && is_ipv6(out.host, v6)) {
        out.is_ipv6 = true;
        out.is_loopback = IN6_IS_ADDR_LOOPBACK(&v6);
        return out;
    }
    return std::nullopt;
}

bool is_host_allowed(std::string_view text) {
    std::string host;
    std::string_view port;
    if (!split_host(text, host, port)) {
        return false;
    }
    in_addr v4{};
    in6_addr v6{};
    if (text.starts_with('[')) {
        return is_ipv6(host, v6);
    }
    return host == "localhost" || is_ipv4(host, v4);
}

}  // namespace axg
