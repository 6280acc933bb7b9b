// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/past_motion.hpp"

#include <algorithm>

namespace axg {

namespace {

constexpr double kPastSecondsPerUs = 1e-6;
constexpr std::int64_t kShortestPartUs = 50;  // ticks cut the parts; full ones are longer

}  // namespace

PastMotion::PastMotion(std::int64_t longest_us)
    : notes_(static_cast<std::size_t>(longest_us / kShortestPartUs) + 4) {}

void PastMotion::note(std::int64_t time_us, const AxisMotions& axes) {
    notes_[count_++ % notes_.size()] = {time_us, axes};
}

/// Evaluates a cubic through two positions and their speeds: exact at a constant jerk.
double PastMotion::position(std::int64_t time_us, std::size_t axis) const {
    const std::size_t kept = std::min(count_, notes_.size());
    std::size_t before = 0;
    while (before + 1 < kept && back(before).time_us > time_us) {
        ++before;
    }
    const Note& from = back(before);
    if (before == 0 || from.time_us >= time_us) {
        return from.axes[axis].position;
    }
    const Note& to = back(before - 1);
    const double span = static_cast<double>(to.time_us - from.time_us) * kPastSecondsPerUs;
    const double u = static_cast<double>(time_us - from.time_us) * kPastSecondsPerUs / span;
    const double a = from.axes[axis].position, b = to.axes[axis].position;
    const double slope_a = from.axes[axis].speed * span - (b - a);
    const double slope_b = (b - a) - to.axes[axis].speed * span;
    return a + u * (b - a) + u * (1 - u) * ((1 - u) * slope_a + u * slope_b);
}

}  // namespace axg
