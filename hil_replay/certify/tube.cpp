// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/tube.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/base/assert.hpp"
#include "core/reach/stop_limits.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {
namespace {

constexpr double kTubeUp = 1.0 + 0x1p-40;  // exceeds the roundings of the formulas below
constexpr auto kPartsSigned = static_cast<std::int64_t>(kPartsOfSegment);

UnitBox empty_box() noexcept {
    UnitBox box;
    box.low.fill(std::numeric_limits<std::int64_t>::max());
    box.high.fill(std::numeric_limits<std::int64_t>::min());
    return box;
}

std::int64_t floor_of_parts(std::int64_t value) noexcept {
    return value >= 0 ? value / kPartsSigned : -((-value + kPartsSigned - 1) / kPartsSigned);
}

}  // namespace

JointBox joint_box(const Machine& machine, const UnitBox& box) noexcept {
    JointBox out;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double half_unit = 0.5 * unit_of(machine.axes[i].kind);
        out.centre[i] = static_cast<double>(box.low[i] + box.high[i]) * half_unit;
        out.half[i] = static_cast<double>(box.high[i] - box.low[i]) * half_unit;
    }
    return out;
}

UnitBox half_of(const UnitBox& box, std::uint32_t axis, bool is_upper) noexcept {
    UnitBox out = box;
    const std::int64_t middle = box.low[axis] + (box.high[axis] - box.low[axis]) / 2;
    (is_upper ? out.low : out.high)[axis] = middle;
    return out;
}

double stop_way(const Machine& machine, std::uint32_t axis, double speed) noexcept {
    const Axis& of = machine.axes[axis];
    AxisLimits limits = stop_limits(machine, axis);
    const double error =
        static_cast<double>(units_up(of.following_error + of.position_error, of.kind)) *
        unit_of(of.kind);
    // Bounds the difference of speeds of two motions this near to each other, with up to a each.
    const double swing = 2 * std::sqrt(2 * of.acceleration_max * error);
    const double fastest = std::min(of.speed_max, (speed + swing) * kTubeUp);
    if (machine.guard.free_jerk_limited) {
        // Without the stop the axis would have gone on at no more than this speed. So the stop
        // begins with at most this acceleration, which its jerk removes first.
        limits.speed_max = fastest;
        limits.stop_turns_round = false;
        const double j = limits.jerk_max;
        const double b = std::min(limits.acceleration_max, std::sqrt(2 * j * fastest));
        const double rise = fastest * b / j * kTubeUp - b * b * b / (6 * j * j) / kTubeUp;
        const double after = forward_reach(limits, fastest, fastest, 0, 0);
        return fastest > 0
                   ? std::min(forward_reach(limits, 0, fastest, 0), (rise + after) * kTubeUp)
                   : 0;
    }
    if (!(fastest > 0) && !limits.stop_turns_round) {
        return 0;
    }
    limits.stop_turns_round = true;  // its bound at rest holds for every start
    return forward_reach(limits, 0, fastest, 0);
}

Tube::Tube(const Machine& machine, const ChordPath& path)
    : machine_(machine), path_(path), leaves_(std::bit_ceil(path.segment_count())) {
    const std::uint32_t axes = path.axis_count;
    if (machine.guard.promise == StopPromise::independent) {
        AXG_ASSERT(path.speeds.size() == path.segment_count() * axes * 2);
        rho_.resize(axes);
        for (std::uint32_t i = 0; i < axes; ++i) {
            for (std::uint32_t byte = 0; byte < 256; ++byte) {
                const double speed = byte / kSpeedSteps * machine.axes[i].speed_max * kTubeUp;
                const double way = stop_way(machine, i, byte == 0 ? 0 : speed);
                rho_[i].way[byte] = way > 0 ? units_up(way, machine.axes[i].kind) + 1 : 0;
            }
        }
    }
    const UnitBox none = empty_box();
    low_.resize(2 * leaves_ * axes, none.low[0]);
    high_.resize(2 * leaves_ * axes, none.high[0]);
    for (std::uint64_t i = 2 * leaves_ - 1; i > 0; --i) {
        UnitBox box = none;
        if (i >= leaves_ && i - leaves_ < path.segment_count()) {
            add_part(i - leaves_, 0, kPartsOfSegment, box);
        }
        for (std::uint32_t axis = 0; axis < axes; ++axis) {
            std::int64_t &low = low_[i * axes + axis], &high = high_[i * axes + axis];
            low = box.low[axis];
            high = box.high[axis];
            if (i < leaves_) {
                low = std::min(low_[2 * i * axes + axis], low_[(2 * i + 1) * axes + axis]);
                high = std::max(high_[2 * i * axes + axis], high_[(2 * i + 1) * axes + axis]);
            }
        }
    }
}

/// Adds a part of a segment, from and to in its parts.
void Tube::add_part(std::uint64_t segment, std::uint64_t from, std::uint64_t to,
                    UnitBox& box) const noexcept {
    for (std::uint32_t i = 0; i < path_.axis_count; ++i) {
        const std::int64_t begin = path_.node(segment, i);
        const std::int64_t way = path_.node(segment + 1, i) - begin;
        const std::int64_t p = begin * kPartsSigned + way * static_cast<std::int64_t>(from);
        const std::int64_t q = begin * kPartsSigned + way * static_cast<std::int64_t>(to);
        std::int64_t up = path_.delta[i] + path_.following[i], down = up;
        if (!rho_.empty()) {
            const std::uint64_t at = (segment * path_.axis_count + i) * 2;
            up += rho_[i].way[path_.speeds[at]];
            down += rho_[i].way[path_.speeds[at + 1]];
        }
        box.low[i] = std::min(box.low[i], floor_of_parts(std::min(p, q)) - down);
        box.high[i] = std::max(box.high[i], -floor_of_parts(-std::max(p, q)) + up);
    }
}

void Tube::add_whole(std::uint64_t first, std::uint64_t end, UnitBox& box) const noexcept {
    const std::uint32_t axes = path_.axis_count;
    const auto add_node = [&](std::uint64_t node) {
        for (std::uint32_t i = 0; i < axes; ++i) {
            box.low[i] = std::min(box.low[i], low_[node * axes + i]);
            box.high[i] = std::max(box.high[i], high_[node * axes + i]);
        }
    };
    for (std::uint64_t a = first + leaves_, b = end + leaves_; a < b; a /= 2, b /= 2) {
        if (a % 2 != 0) {
            add_node(a++);
        }
        if (b % 2 != 0) {
            add_node(--b);
        }
    }
}

UnitBox Tube::box(const PathInterval& stretch) const noexcept {
    AXG_ASSERT(stretch.begin < stretch.end &&
               stretch.end <= path_.segment_count() * kPartsOfSegment);
    UnitBox out = empty_box();
    const std::uint64_t first = stretch.first_segment(), last = stretch.end_segment() - 1;
    const std::uint64_t from = stretch.begin - first * kPartsOfSegment;
    const std::uint64_t to = stretch.end - last * kPartsOfSegment;
    if (first == last) {
        add_part(first, from, to, out);
        return out;
    }
    add_part(first, from, kPartsOfSegment, out);
    add_part(last, 0, to, out);
    add_whole(first + 1, last, out);
    return out;
}

}  // namespace axg
