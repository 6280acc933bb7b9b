// SPDX-License-Identifier: Apache-2.0
#include "core/path_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/assert.hpp"
#include "core/sincos.hpp"

namespace axg {

namespace {

constexpr double kUp = 1.0 + 0x1p-40;    // more than the roundings of any formula below
constexpr double kPositionUp = 0x1p-30;  // and than those of positions up to 1e5
// Pictures may be lost, and a cycle may be late: so many points behind the newest picture stay.
constexpr std::uint32_t kPointsBehind = 64;

}  // namespace

double path_braking_s(double deceleration_ratio, double jerk_ratio) noexcept {
    const double p = deceleration_ratio, z = jerk_ratio;
    if (z >= 2 * p * p) {  // at rest before the deceleration is full
        return 2.0 / 3.0 * std::sqrt(2 * z) * kUp;
    }
    return (0.5 * p + z / (2 * p) - z * z / (24 * p * p * p)) * kUp;
}

PathAhead::PathAhead(const Machine& machine, const PathOptions& options, Arena arena) noexcept
    : machine_(&machine),
      options_(options),
      period_s_(machine.can.sample_us * 1e-6),
      arena_(std::move(arena)) {}

std::optional<PathAhead> PathAhead::create(const Machine& machine, const PathOptions& options) {
    const std::size_t count = machine.can.ahead_samples + kPointsBehind;
    Arena arena(Arena::size_bytes<Point>(count));
    if (!arena.ok()) {
        return std::nullopt;
    }
    PathAhead path(machine, options, std::move(arena));
    path.ring_ = path.arena_.take<Point>(count);
    path.arena_.seal();
    return path;
}

/// Endless axes go the short way round.
double PathAhead::step(std::uint32_t axis, double from, double to) const noexcept {
    const double moved = to - from;
    return machine_->axes[axis].unlimited ? moved - 2 * kPi * std::round(moved / (2 * kPi)) : moved;
}

bool PathAhead::add(std::uint64_t sample, const std::array<double, kAxesMax>& position) noexcept {
    if (holds(sample)) {
        return point(sample).is_bridge || point(sample).position == position;
    }
    if (!is_empty_ && sample < first_) {
        return true;  // older than anything that is still asked for
    }
    const std::uint64_t gap = is_empty_ ? 1 : sample - last_;
    if (is_empty_ || gap > kPathGapMax) {
        is_empty_ = false;
        first_ = last_ = sample;
        point(sample) = {position, 1, false};
        return true;
    }
    const Point from = point(last_);
    for (std::uint64_t i = 1; i < gap; ++i) {
        Point& bridge = point(last_ + i);
        bridge = {from.position, static_cast<std::uint32_t>(gap), true};
        const double share = static_cast<double>(i) / static_cast<double>(gap);
        for (std::uint32_t axis = 0; axis < machine_->axes.size(); ++axis) {
            bridge.position[axis] += share * step(axis, from.position[axis], position[axis]);
        }
    }
    last_ = sample;
    point(sample) = {position, static_cast<std::uint32_t>(gap), false};
    first_ = last_ - first_ < ring_.size() ? first_ : last_ - ring_.size() + 1;
    return true;
}

bool PathAhead::announce(const PathPoints& points) noexcept {
    const bool is_same = add(points.sample - 1, points.before);
    if (is_same && add(points.sample, points.position)) {
        return true;
    }
    clear();
    (void)add(points.sample - 1, points.before);
    (void)add(points.sample, points.position);
    return false;
}

/// How far the path may lie off the chord that ends at `sample`.
double PathAhead::bulge(std::uint32_t axis, std::uint64_t sample) const noexcept {
    const double time = point(sample).gap * period_s_;
    return machine_->axes[axis].acceleration_max * time * time / 8;
}

/// Largest |q'| in the step that ends at `sample`: its mean, and what the speed may change by in
/// half of the chord's time.
double PathAhead::speed_in_step(std::uint32_t axis, std::uint64_t sample) const noexcept {
    const Axis& promised = machine_->axes[axis];
    const Point &to = point(sample), &from = point(sample - 1);
    const double count = options_.count[axis];
    const double moved = step(axis, from.position[axis], to.position[axis]);
    double acceleration = promised.acceleration_max;
    if (machine_->guard.free_jerk_limited && to.gap == 1 && from.gap == 1 && holds(sample - 2)) {
        // The second difference is a mean of the acceleration over two periods, centred on the
        // beginning of this step, so at most a period away from any instant of it.
        const double before = step(axis, point(sample - 2).position[axis], from.position[axis]);
        const double mean = (std::fabs(moved - before) + 2 * count) / (period_s_ * period_s_);
        acceleration = std::min(acceleration, mean + promised.jerk_max * period_s_);
    }
    const double speed =
        (std::fabs(moved) + count) / period_s_ + 0.5 * acceleration * to.gap * period_s_;
    return std::min(speed, promised.speed_max) * kUp;
}

bool PathAhead::keeps_to(const AxisPicture& picture) const noexcept {
    if (!holds(picture.sample)) {
        return true;
    }
    const Point& said = point(picture.sample);
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        const Axis& axis = machine_->axes[i];
        double speed = axis.speed_max;
        if (holds(picture.sample - 1) && holds(picture.sample + 1)) {
            speed =
                std::max(speed_in_step(i, picture.sample), speed_in_step(i, picture.sample + 1));
        }
        const double bridge = said.is_bridge ? bulge(i, picture.sample) : 0;
        // Half a count of either frame, and what a position on the wire is off.
        const double allowed = axis.following_error + axis.position_error + options_.count[i] +
                               speed * machine_->guard.latch_jitter_s + bridge + kPositionUp;
        if (!(std::fabs(step(i, said.position[i], picture.position[i])) <= allowed)) {
            return false;
        }
    }
    return true;
}

PathStretch PathAhead::stretch(std::uint64_t sample, double free_s) const noexcept {
    PathStretch out;
    if (!holds(sample)) {
        return out;
    }
    Ratios most;
    for (std::uint64_t at = sample + 1; holds(at); ++at) {
        for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
            const Axis& axis = machine_->axes[i];
            const double speed = speed_in_step(i, at);
            most.deceleration = std::max(most.deceleration, speed / axis.stopping_min);
            most.jerk = std::max(most.jerk, speed / axis.jerk_max);
        }
        const double jerk = options_.forgets_jerk_ramp ? 0 : most.jerk;
        const double end_s = free_s + path_braking_s(most.deceleration, jerk);
        const double periods = end_s / period_s_ * kUp;
        if (periods <= static_cast<double>(at - sample)) {
            return {true, periods};
        }
    }
    return out;
}

void PathAhead::cut(std::uint64_t sample, double end,
                    std::span<JointBox, kPathPieces> out) const noexcept {
    AXG_ASSERT(holds(sample) && end >= 0);
    constexpr std::uint32_t kFirstLeaf = kPathLeaves - 1;
    std::array<double, kAxesMax> from = at(sample), low, high;  // unwrapped from here on
    std::uint64_t ahead = 1;                                    // the step that `from` lies in
    const auto count = static_cast<std::uint32_t>(machine_->axes.size());
    double begin = 0;
    for (std::uint32_t leaf = 0; leaf < kPathLeaves; ++leaf) {
        const double until = end * (leaf + 1) / kPathLeaves;
        std::array<double, kAxesMax> off{};
        low = high = from;
        while (begin < until) {
            AXG_ASSERT(holds(sample + ahead));
            const Point &a = point(sample + ahead - 1), &b = point(sample + ahead);
            const double to = std::min(until, static_cast<double>(ahead));
            for (std::uint32_t i = 0; i < count; ++i) {
                from[i] += (to - begin) * step(i, a.position[i], b.position[i]);
                low[i] = std::min(low[i], from[i]);
                high[i] = std::max(high[i], from[i]);
                off[i] = std::max(off[i], bulge(i, sample + ahead));
            }
            begin = to;
            ahead += to >= static_cast<double>(ahead) ? 1 : 0;
        }
        JointBox& box = out[kFirstLeaf + leaf];
        box = {};
        for (std::uint32_t i = 0; i < count; ++i) {
            const double wide =
                off[i] + machine_->axes[i].following_error + 0.5 * options_.count[i] + kPositionUp;
            box.centre[i] = 0.5 * (low[i] + high[i]);
            box.half[i] = (0.5 * (high[i] - low[i]) + wide) * kUp;
        }
    }
    for (std::uint32_t node = kFirstLeaf; node-- > 0;) {
        const JointBox &a = out[2 * node + 1], &b = out[2 * node + 2];
        out[node] = {};
        for (std::uint32_t i = 0; i < count; ++i) {
            const double least = std::min(a.centre[i] - a.half[i], b.centre[i] - b.half[i]);
            const double most = std::max(a.centre[i] + a.half[i], b.centre[i] + b.half[i]);
            out[node].centre[i] = 0.5 * (least + most);
            out[node].half[i] = 0.5 * (most - least) * kUp + kPositionUp;
        }
    }
}

}  // namespace axg
