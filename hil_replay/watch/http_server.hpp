// SPDX-License-Identifier: Apache-2.0
// A few texts and a stream of events over HTTP, read-only: GET alone, names looked up in a table,
// never in the file system. libmicrohttpd reads and writes in a thread of its own, so no client can
// delay the publisher; the limits are below. Source of the API: microhttpd.h.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace axg {

inline constexpr unsigned kHttpClientsMax = 32;             // connections; more are closed at once
inline constexpr unsigned kHttpStreamsMax = 16;             // of these, that read events
inline constexpr unsigned kHttpIdleSecondsMax = 10;         // without a byte read or written
inline constexpr std::size_t kHttpRequestBytesMax = 16384;  // head; more than that is refused

struct HttpPart {
    std::string type, body;
};
using HttpParts = std::map<std::string, HttpPart, std::less<>>;  // by path, "/" is the page

struct ListenAddress {
    std::string host;  // numeric, without brackets
    std::uint16_t port = 0;
    bool is_ipv6 = false, is_loopback = false;
};
/// "127.0.0.1:8642", "[::1]:8642", "localhost:8642". nullopt: no such address.
[[nodiscard]] std::optional<ListenAddress> read_listen_address(std::string_view text);

/// Whether a request that names this host was meant for this server: localhost or a numeric
/// address, with any port. Any other name may be an attacker's that resolves to this computer (DNS
/// rebinding).
[[nodiscard]] bool is_host_allowed(std::string_view text);

class HttpServer {
  public:
    /// Listens, and serves from now on. Null: `fault` has the failure and the next step.
    /// @param parts  in addition to /events, the stream, and /state, its newest event alone
    /// (503 before the first)
    [[nodiscard]] static std::unique_ptr<HttpServer> start(const ListenAddress& address,
                                                           HttpParts parts, std::string& fault);
    /// False: built without libmicrohttpd.
    [[nodiscard]] static bool is_built() noexcept;
    ~HttpServer();
    HttpServer(const HttpServer&) = delete;
    HttpServer& operator=(const HttpServer&) = delete;

    /// The newest event, one line; a client that reads slowly misses those before. Never waits for
    /// a client.
    void publish(std::string event);
    /// The port that it listens at.
    [[nodiscard]] std::uint16_t port() const noexcept;

  private:
    struct Impl;
    explicit HttpServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace axg
