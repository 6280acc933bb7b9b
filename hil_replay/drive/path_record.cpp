// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/path_record.hpp"

namespace axg {

void PathRecord::add(std::int64_t time_us, std::span<const AxisMotion> axes, std::uint16_t tool) {
    instants_.push_back({time_us, tool});
    for (const AxisMotion& axis : axes) {
        positions_.push_back(axis.position);
    }
}

void PathRecord::show(PathJudge& judge) const {
    if (instants_.empty()) {
        return;
    }
    const std::size_t axis_count = positions_.size() / instants_.size();
    AxisMotions axes{};
    auto position = positions_.begin();
    for (const Instant& instant : instants_) {
        for (std::size_t i = 0; i < axis_count; ++i) {
            axes[i].position = *position++;
        }
        judge.look(instant.time_us, {axes.data(), axis_count}, instant.tool);
        if (judge.contact()) {
            return;
        }
    }
}

}  // namespace axg
