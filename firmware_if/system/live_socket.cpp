// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/system/live_socket.hpp"

#include <algorithm>

#include "firmware_if/guard/guard_node.hpp"
#include "firmware_if/protocol/axis_frames.hpp"

namespace axg {

std::optional<SocketCan> open_live_socket(const Machine& machine, const std::string& interface,
                                          std::int32_t receive_buffer_bytes, std::string& fault) {
    SocketOptions options;
    options.interface = interface;
    static_assert(kLiveIdsMax <= kCanFiltersMax);
    options.ids.count = live_ids(machine, options.ids.id);
    const AxisFrameSet set = make_frame_set(machine);
    options.is_fd =
        std::find(set.is_flexible.begin(), set.is_flexible.end(), true) != set.is_flexible.end();
    options.receive_buffer_bytes = receive_buffer_bytes;
    return SocketCan::open(options, fault);
}

}  // namespace axg
