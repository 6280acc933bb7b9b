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
    if (has_sync(wire_of(can))) {
        add(can.sync_id);
        add(can.heartbeat_in_id);
    }
    for (const std::uint32_t id :
         {can.permit_id, can.permit_id + 1, can.stop_id, can.emergency_id, can.heartbeat_out_id}) {
        add(id);
    }
    if (set.session_id != 0) {
        add(set.session_id);
        add(can.hints_id);
        add(can.operator_in_id);
        add(can.operator_out_id);
    }
    if (can.hashes_out_id != 0) {
        add(can.hashes_in_id);
        add(can.hashes_out_id);
    }
    for (const std::uint32_t id : can.quick_stop_ids) {
        add(id);
    }
    return count;
}

bool is_guard_id(const CanLayout& can, std::uint32_t id) noexcept {
    return id == can.permit_id || id == can.permit_id + 1 || id == can.emergency_id ||
           id == can.heartbeat_out_id || (id == can.hashes_out_id && id != 0) ||
           (has_sample_counter(can) && (id == can.hints_id || id == can.operator_out_id)) ||
           (can.guard_sends_sync && id == can.sync_id) ||
           std::find(can.quick_stop_ids.begin(), can.quick_stop_ids.end(), id) !=
               can.quick_stop_ids.end();
}

bool is_stop_frame(const CanLayout& can, const CanFrame& frame) noexcept {
    return !frame.error && !frame.extended && !frame.remote && frame.id == can.stop_id;
}

}  // namespace axg
