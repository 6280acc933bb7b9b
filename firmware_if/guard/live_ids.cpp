// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/guard/live_ids.hpp"

#include <algorithm>

#include "core/base/assert.hpp"

namespace axg {

std::uint32_t live_ids(const Machine& machine, std::span<std::uint32_t> out) noexcept {
    const CanLayout& can = machine.can;
    const AxisFrameSet set = make_frame_set(machine);
    std::uint32_t count = 0;
    const auto add = [&](std::uint32_t id) {
        AXG_ASSERT(count < out.size());  // without an id its frames would never be seen
        out[count++] = id;
    };
    for (std::uint32_t i = 0; i < set.frame_count; ++i) {
        add(set.ids[i]);
    }
    if (set.look_ahead_samples != 0) {
        add(set.look_ahead_id);
    }
    add(can.permit_id + 1);
    for (const FrameId& row : kFrameIds) {
        if (is_used(can, row.use)) {
            add(can.*row.id);
        }
    }
    for (const std::uint32_t id : can.quick_stop_ids) {
        add(id);
    }
    return count;
}

bool is_guard_id(const CanLayout& can, std::uint32_t id) noexcept {
    const auto has_id = [&](const FrameId& row) {
        return row.is_of_guard && is_used(can, row.use) && can.*row.id == id;
    };
    return id == can.permit_id + 1 || (can.guard_sends_sync && id == can.sync_id) ||
           std::any_of(kFrameIds.begin(), kFrameIds.end(), has_id) ||
           std::find(can.quick_stop_ids.begin(), can.quick_stop_ids.end(), id) !=
               can.quick_stop_ids.end();
}

bool is_stop_frame(const CanLayout& can, const CanFrame& frame) noexcept {
    return !frame.error && !frame.extended && !frame.remote && frame.id == can.stop_id;
}

}  // namespace axg
