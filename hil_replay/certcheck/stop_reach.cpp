// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/stop_reach.hpp"

#include "hil_replay/certcheck/byte_reader.hpp"

namespace axg::certcheck {
namespace {

/// The way to standstill from speed x and acceleration b: the acceleration falls by the jerk to the
/// stopping deceleration, unless the speed is 0 before, and stays there.
Interval braking(const Axis& axis, Interval x, Interval b) {
    const Interval d = axis.stopping, j = axis.jerk;
    const Interval g = min((b + d) / j, (b + root(square(b) + 2 * j * x)) / j);
    const Interval way = g * (x + g * (b / 2 - g * j / 6));
    const Interval rest = max(0, x + g * (b - j * g / 2));
    return way + square(rest) / (2 * d);
}

}  // namespace

std::int64_t stop_reach(const Model& model, const Axis& axis, std::int64_t following, int speed) {
    const Interval v = axis.speed, a = axis.acceleration, j = axis.jerk;
    const Interval f = static_cast<double>(following) * axis.unit;  // exact
    const Interval u = min(v, speed * v / 255 + 2 * root(2 * a * f));
    if (!model.has_free_jerk && !model.turns_round && speed == 0 && following == 0) {
        return 0;
    }
    const Interval most = model.has_free_jerk ? u : v;
    const Interval b = min(a, root(2 * j * most));
    Interval later = most * b / j + braking(axis, most, 0);
    if (model.has_free_jerk) {
        later = later - b * b * b / (6 * square(j));
    }
    const double units = std::ceil(min(braking(axis, u, a), later).high / axis.unit);
    if (!(units >= 0 && units <= 0x1p44)) {
        throw Refusal{10, "the stopping distance of axis " + axis.name + " is out of range"};
    }
    return static_cast<std::int64_t>(units);
}

}  // namespace axg::certcheck
