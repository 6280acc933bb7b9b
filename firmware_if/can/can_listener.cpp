// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/can/can_listener.hpp"

namespace axg {

std::optional<CanListener> CanListener::open(const SocketOptions& options, std::string& fault) {
    std::optional<SocketCan> wire = SocketCan::open(options, fault);
    if (!wire) {
        return std::nullopt;
    }
    return CanListener(std::move(*wire));
}

}  // namespace axg
