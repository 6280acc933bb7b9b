// SPDX-License-Identifier: Apache-2.0
// A client that sends any bytes and takes what comes, for tests of the live page's server.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

namespace axg::test {

class HttpClient {
  public:
    /// @param receive_bytes  of the socket's own buffer; 0: the system's
    explicit HttpClient(std::uint16_t port, int receive_bytes = 0)
        : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        if (receive_bytes != 0) {
            setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
        }
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_port = htons(port);
        at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        is_connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
    }
    ~HttpClient() { close(socket_); }
    HttpClient(HttpClient&& other) noexcept
        : socket_(std::exchange(other.socket_, -1)), is_connected_(other.is_connected_) {}
    HttpClient& operator=(HttpClient&&) = delete;

    [[nodiscard]] bool is_connected() const { return is_connected_; }
    /// False: the other side has closed.
    bool say(std::string_view bytes) {
        return send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
               static_cast<ssize_t>(bytes.size());
    }
    /// What comes until the text contains `until` (empty: until the other side closes), for as
    /// long as stated.
    std::string take(std::string_view until, int wait_ms = 5000) {
        std::string text;
        const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(wait_ms);
        while (until.empty() || text.find(until) == std::string::npos) {
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                                  end - std::chrono::steady_clock::now())
                                  .count();
            pollfd waits{.fd = socket_, .events = POLLIN, .revents = 0};
            if (left <= 0 || poll(&waits, 1, static_cast<int>(left)) <= 0) {
                break;
            }
            char part[4096];
            const ssize_t size = recv(socket_, part, sizeof part, 0);
            if (size <= 0) {
                is_closed_ = true;
                break;
            }
            text.append(part, static_cast<std::size_t>(size));
        }
        return text;
    }
    [[nodiscard]] bool is_closed() const { return is_closed_; }

  private:
    int socket_;
    bool is_connected_ = false, is_closed_ = false;
};

/// The whole reply to a request; the connection is closed by the server.
inline std::string reply_to(std::uint16_t port, const std::string& request) {
    HttpClient client(port);
    client.say(request);
    return client.take("");
}

inline std::string get(std::uint16_t port, const std::string& path,
                       const std::string& host = "localhost", const std::string& more = "") {
    return reply_to(port, "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + more +
                              "Connection: close\r\n\r\n");
}

/// 0: no reply.
inline int status_of(const std::string& reply) {
    return reply.starts_with("HTTP/1.") && reply.size() > 12 ? std::atoi(reply.c_str() + 9) : 0;
}

}  // namespace axg::test
