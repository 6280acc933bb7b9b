// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/socket_clock.hpp"

#include <poll.h>

#include <algorithm>

namespace axg {

LiveClock socket_clock(const SocketCan& wire) {
    return {.now_us = monotonic_us, .wait = [&wire](std::int64_t until_us) {
                pollfd wait{.fd = wire.descriptor(), .events = POLLIN, .revents = 0};
                const std::int64_t left_us = std::max<std::int64_t>(0, until_us - monotonic_us());
                const timespec timeout{.tv_sec = left_us / 1'000'000,
                                       .tv_nsec = left_us % 1'000'000 * 1000};
                ppoll(&wait, 1, &timeout, nullptr);
            }};
}

}  // namespace axg
