// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/service_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace axg {
namespace {

/// A socket that has the service manager as its only peer; negative: there is none.
int connect_to(const char* path) noexcept {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::size_t size = path == nullptr ? 0 : std::strlen(path);
    if (size < 2 || size >= sizeof address.sun_path || (path[0] != '/' && path[0] != '@')) {
        return -1;
    }
    std::memcpy(address.sun_path, path, size);
    if (path[0] == '@') {  // a name without a file
        address.sun_path[0] = '\0';
    }
    const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + size);
    if (socket >= 0 && connect(socket, reinterpret_cast<const sockaddr*>(&address), length) != 0) {
        close(socket);
        return -1;
    }
    return socket;
}

std::int64_t number_of(const char* name) noexcept {
    const char* const text = std::getenv(name);
    return text == nullptr ? 0 : std::strtoll(text, nullptr, 10);
}

}  // namespace

ServiceNotify::ServiceNotify() noexcept : socket_(connect_to(std::getenv("NOTIFY_SOCKET"))) {
    const std::int64_t watched = number_of("WATCHDOG_PID");
    if (watched == 0 || watched == getpid()) {
        watchdog_us_ = std::max<std::int64_t>(0, number_of("WATCHDOG_USEC"));
    }
}

ServiceNotify::~ServiceNotify() {
    if (socket_ >= 0) {
        close(socket_);
    }
}

void ServiceNotify::work(std::uint32_t period, std::int64_t now_us) noexcept {
    if (period == period_) {
        return;  // the bus thread is blocked or not started: the watchdog has to end the process
    }
    if (!is_ready_) {
        is_ready_ = true;
        send("READY=1");
    }
    const bool is_due = watchdog_us_ > 0 && now_us - fed_us_ >= watchdog_us_ / 4;
    if (is_due) {
        fed_us_ = now_us;
        period_ = period;
        send("WATCHDOG=1");
    }
}

void ServiceNotify::status(std::string_view words) noexcept {
    std::array<char, 256> text{};
    constexpr std::string_view kKey = "STATUS=";
    const std::size_t size = std::min(words.size(), text.size() - kKey.size());
    std::copy(kKey.begin(), kKey.end(), text.begin());
    std::copy_n(words.begin(), size, text.begin() + kKey.size());
    send({text.data(), kKey.size() + size});
}

/// Loses the datagram if the manager is slow: watchdog and status repeat, READY=1 does not.
void ServiceNotify::send(std::string_view words) noexcept {
    if (socket_ >= 0) {
        [[maybe_unused]] const ssize_t sent =
            ::send(socket_, words.data(), words.size(), MSG_NOSIGNAL);
    }
}

}  // namespace axg
