// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/status_socket.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>
#include <utility>

namespace axg {
namespace {

constexpr int kAnswerMs = 2000;  // for the reply; a guard held for longer has stopped anyway

constexpr std::string_view kServiceFolder = "/run/axguardd/", kServiceSocket = "/status";

/// Of the service, where the socket is its own: a person at the machine starts no axguardd by hand.
std::string how_to_start(std::string_view path) {
    if (!path.starts_with(kServiceFolder) || !path.ends_with(kServiceSocket) ||
        path.size() <= kServiceFolder.size() + kServiceSocket.size()) {
        return "Start axguardd run with --status-socket.";
    }
    path.remove_prefix(kServiceFolder.size());
    path.remove_suffix(kServiceSocket.size());
    return fmt::format(
        "Start it: sudo systemctl start axguardd@{0}. Why it ended: journalctl -u axguardd@{0}.",
        path);
}

/// False: no name of a socket.
bool set_address(const std::string& path, sockaddr_un& address) noexcept {
    address = {};
    address.sun_family = AF_UNIX;
    if (path.empty() || path.size() >= sizeof address.sun_path) {
        return false;
    }
    std::memcpy(address.sun_path, path.data(), path.size());
    return true;
}

int make_socket(int flags) noexcept {
    return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0);
}

bool connect_to(int socket, const sockaddr_un& address) noexcept {
    return connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

/// Whether the name is free, or is that of a socket that no process serves any more.
bool is_free(const std::string& path, const sockaddr_un& address, std::string& fault) {
    struct stat status {};
    if (lstat(path.c_str(), &status) != 0) {
        if (errno != ENOENT) {
            fault =
                fmt::format("{}: cannot create the status socket: {}", path, std::strerror(errno));
        }
        return errno == ENOENT;
    }
    if (!S_ISSOCK(status.st_mode)) {
        fault = fmt::format(
            "{}: not a socket. Remove it, or pass another name with --status-socket.", path);
        return false;
    }
    const int probe = make_socket(SOCK_NONBLOCK);
    const bool is_stale = probe >= 0 && !connect_to(probe, address) && errno == ECONNREFUSED;
    if (probe >= 0) {
        close(probe);
    }
    if (is_stale && unlink(path.c_str()) == 0) {
        return true;
    }
    fault = is_stale
                ? fmt::format("{}: cannot remove an old socket: {}", path, std::strerror(errno))
                : fmt::format(
                      "{}: another process serves this socket. End it, or pass another name with "
                      "--status-socket.",
                      path);
    return false;
}

using Clock = std::chrono::steady_clock;

/// Waits for more. False: the time is up.
bool await_more(int socket, Clock::time_point until) noexcept {
    for (;;) {
        const auto left =
            std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
        if (left <= 0) {
            return false;
        }
        pollfd waits{.fd = socket, .events = POLLIN, .revents = 0};
        const int ready = poll(&waits, 1, static_cast<int>(left));
        if (ready >= 0 || errno != EINTR) {
            return ready > 0;
        }
    }
}

/// Reads until the other side closes or has sent the size of a status. False: neither in time.
bool read_all(int socket, Clock::time_point until, std::string& text) {
    std::array<char, StatusSocket::kTextMax> part{};
    while (text.size() < StatusSocket::kTextMax) {
        if (!await_more(socket, until)) {
            return false;
        }
        const ssize_t size = recv(socket, part.data(), part.size(), MSG_DONTWAIT);
        if (size <= 0) {
            return size == 0;
        }
        text.append(part.data(), static_cast<std::size_t>(size));
    }
    return true;
}

}  // namespace

StatusSocket::~StatusSocket() {
    if (socket_ < 0) {
        return;
    }
    struct stat status {};
    if (lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_) {
        unlink(path_.c_str());
    }
    close(socket_);
}

StatusSocket::StatusSocket(StatusSocket&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      path_(std::move(other.path_)),
      device_(other.device_),
      inode_(other.inode_) {}

StatusSocket& StatusSocket::operator=(StatusSocket&& other) noexcept {
    std::swap(socket_, other.socket_);
    std::swap(path_, other.path_);
    std::swap(device_, other.device_);
    std::swap(inode_, other.inode_);
    return *this;
}

StatusSocket StatusSocket::open(const std::string& path, std::string& fault) {
    StatusSocket out;
    fault.clear();
    sockaddr_un address{};
    if (!set_address(path, address)) {
        fault = fmt::format("{}: invalid socket name (expected 1 to {} bytes)", path,
                            sizeof address.sun_path - 1);
        return out;
    }
    if (!is_free(path, address, fault)) {
        return out;
    }
    const int made = make_socket(SOCK_NONBLOCK);
    struct stat status {};
    // Everyone may connect, which is a right to write in the file: state and reason are no secret
    // on a machine, and nothing that is sent to the socket is read.
    if (made < 0 || bind(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        chmod(path.c_str(), 0666) != 0 || lstat(path.c_str(), &status) != 0) {
        fault = fmt::format(
            "{}: cannot create the status socket: {}. Pass a name in a writable folder with "
            "--status-socket.",
            path, std::strerror(errno));
        if (made >= 0) {
            close(made);
        }
        return out;
    }
    out.socket_ = made;
    out.path_ = path;
    out.device_ = status.st_dev;
    out.inode_ = status.st_ino;
    return out;
}

bool StatusSocket::listen() const noexcept {
    return ::listen(socket_, kBacklog) == 0;
}

bool StatusSocket::await(int wait_ms) const noexcept {
    pollfd waits{.fd = socket_, .events = POLLIN, .revents = 0};
    return poll(&waits, 1, wait_ms) > 0 && (waits.revents & POLLIN) != 0;
}

int StatusSocket::accept_waiting(Readers& readers) const noexcept {
    int count = 0;
    for (int& reader : readers) {
        reader = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (reader < 0) {
            break;
        }
        ++count;
    }
    return count;
}

void StatusSocket::hand_over(std::span<const int> readers, std::span<const char> text) noexcept {
    for (const int reader : readers) {
        // The whole text, unless the reader has no room even for this: it must connect again.
        [[maybe_unused]] const ssize_t sent =
            send(reader, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        close(reader);
    }
}

std::string status_path(const std::string& bus, const std::string& socket) {
    return socket.empty() ? fmt::format("{}{}{}", kServiceFolder, bus, kServiceSocket) : socket;
}

std::string read_status(const std::string& path, std::string& fault) {
    fault.clear();
    sockaddr_un address{};
    const int made = make_socket(0);
    if (made < 0 || !set_address(path, address)) {
        fault = fmt::format("{}: invalid socket name", path);
        if (made >= 0) {
            close(made);
        }
        return {};
    }
    const Clock::time_point until = Clock::now() + std::chrono::milliseconds(kAnswerMs);
    const timeval limit{.tv_sec = kAnswerMs / 1000, .tv_usec = 0};
    setsockopt(made, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);  // of connect
    std::string text;
    if (!connect_to(made, address)) {
        fault = errno == ENOENT || errno == ECONNREFUSED
                    ? fmt::format("{}: no guard. {}", path, how_to_start(path))
                    : fmt::format("{}: {}", path, std::strerror(errno));
        close(made);
        return {};
    }
    if (!read_all(made, until, text)) {
        fault = fmt::format("{}: no reply from the guard within {} ms", path, kAnswerMs);
    }
    close(made);
    return text;
}

}  // namespace axg
