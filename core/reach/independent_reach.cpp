// SPDX-License-Identifier: Apache-2.0
#include "core/reach/independent_reach.hpp"

#include <algorithm>

namespace axg {

Reach independent_reach(const Machine& machine, const SampledMotion& motion, std::uint32_t samples,
                        const std::array<double, kAxesMax>& speeds) noexcept {
    const double free_s = free_seconds(machine, samples);
    Reach reach{.is_known = motion.has_speed()};
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        AxisLimits limits = stop_limits(machine, i);
        limits.speed_max = std::min(limits.speed_max, speeds[i]);
        put_reach(
            axis_reach(machine, i, limits, motion.now(i), free_s, motion.errors_of(i).position), i,
            reach.box);
    }
    return reach;
}

}  // namespace axg
