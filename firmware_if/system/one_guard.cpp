// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/one_guard.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace axg {

OneGuard::OneGuard(const std::string& bus)
    : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (socket_ < 0) {
        fault_ = fmt::format("no socket: {}; see ulimit -n", std::strerror(errno));
        return;
    }
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = "axguardd/" + bus;  // behind a zero byte: no file
    std::copy_n(name.begin(), std::min(name.size(), sizeof address.sun_path - 1),
                address.sun_path + 1);
    shutdown(socket_, SHUT_RD);  // a name and nothing else: whoever writes to it gets EPIPE
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
        return;
    }
    fault_ =
        errno == EADDRINUSE
            ? fmt::format("another axguardd guards {}; end that one first: pgrep -a axguardd", bus)
            : fmt::format("{} cannot be claimed: {}", bus, std::strerror(errno));
    close(socket_);
    socket_ = -1;
}

OneGuard::~OneGuard() {
    if (is_mine()) {
        close(socket_);
    }
}

}  // namespace axg
