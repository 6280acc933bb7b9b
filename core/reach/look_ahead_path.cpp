// SPDX-License-Identifier: Apache-2.0
#include "core/reach/look_ahead_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/sincos.hpp"

namespace axg {

namespace {

constexpr double kShareUp = 0x1p-40;  // exceeds the roundings of any formula below
constexpr double kUp = 1.0 + kShareUp;
constexpr double kLongestPeriod = 1 + kPeriodShare;  // of a board, in nominal periods
constexpr double kPositionUp = 0x1p-30;              // exceeds the roundings of positions up to 1e5
// Points stored behind the newest snapshot, for lost snapshots and late cycles.
constexpr std::uint32_t kPointsBehind = 64;
constexpr std::uint64_t kMiddlesMost = 16;  // periods to either side; farther, jerk spoils bounds

/// Largest acceleration of an axis relative to its command, if the axis stays within `error` of it
/// and neither changes its acceleration faster than `jerk`. Three instants, a time L apart, bound
/// it by 4 error / L^2 + 2 jerk L for any L. The best L is the cube root of 4 error / jerk; the
/// iteration approaches it from above.
double swing_acceleration(double error, double jerk) noexcept {
    if (!(error > 0)) {
        return 0;
    }
    const double cube = 4 * error / jerk;
    double time = 1;
    for (int i = 0; i < 64; ++i) {
        time = (2 * time + cube / (time * time)) / 3;
    }
    return (4 * error / (time * time) + 2 * jerk * time) * kUp;
}

}  // namespace

double path_braking_s(double deceleration_ratio, double jerk_ratio) noexcept {
    const double p = deceleration_ratio, z = jerk_ratio;
    if (z >= 2 * p * p) {  // at rest before the deceleration is full
        return 2.0 / 3.0 * std::sqrt(2 * z) * kUp;
    }
    return (0.5 * p + z / (2 * p) - z * z / (24 * p * p * p)) * kUp;
}

LookAheadPath::LookAheadPath(const Machine& machine, const PathOptions& options,
                             Arena arena) noexcept
    : machine_(&machine),
      options_(options),
      period_s_(machine.can.sample_us * 1e-6),
      arena_(std::move(arena)) {
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        swing_[i] = swing_acceleration(machine.axes[i].following_error, machine.axes[i].jerk_max);
    }
}

std::optional<LookAheadPath> LookAheadPath::create(const Machine& machine,
                                                   const PathOptions& options) {
    const std::size_t count = machine.can.look_ahead_samples + kPointsBehind;
    Arena arena(Arena::size_bytes<Point>(count));
    if (!arena.ok()) {
        return std::nullopt;
    }
    LookAheadPath path(machine, options, std::move(arena));
    path.ring_ = path.arena_.take<Point>(count);
    path.arena_.seal();
    return path;
}

/// Difference of two positions; at most half a turn for endless axes.
double LookAheadPath::step(std::uint32_t axis, double from, double to) const noexcept {
    const double moved = to - from;
    return machine_->axes[axis].unlimited ? moved - 2 * kPi * std::round(moved / (2 * kPi)) : moved;
}

bool LookAheadPath::add(std::uint64_t sample,
                        const std::array<double, kAxesMax>& position) noexcept {
    if (holds(sample)) {
        return point(sample).is_bridge || point(sample).position == position;
    }
    if (!is_empty_ && sample < first_) {
        return true;  // older than all stored points
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

/// Whether axes within their limits can pass through the point at `sample` and those one, two and
/// three strides before it, as far as the board sent these. Rejects no path within the limits:
/// docs/theory/certificate.md, "What a path has to keep".
bool LookAheadPath::is_possible(std::uint64_t sample, std::uint32_t stride) const noexcept {
    const std::uint32_t orders_most = machine_->guard.free_jerk_limited ? 3 : 2;
    std::uint32_t orders = 0;
    for (std::uint64_t back = stride; orders < orders_most && sample >= back; back += stride) {
        if (!holds(sample - back) || point(sample - back).is_bridge) {
            break;
        }
        ++orders;
    }
    const double time = stride * period_s_ * (1 + kPeriodShare) * kUp;
    for (std::uint32_t axis = 0; axis < machine_->axes.size(); ++axis) {
        std::array<double, 3> moved{};  // in each stride, the newest first; unwrapped
        for (std::uint64_t i = 0; i < std::uint64_t{orders} * stride; ++i) {
            const Point &from = point(sample - i - 1), &to = point(sample - i);
            moved[i / stride] += step(axis, from.position[axis], to.position[axis]);
        }
        const Axis& most = machine_->axes[axis];
        const double count = options_.count[axis] + 8 * kPositionUp;
        const double second = moved[0] - moved[1], third = second - moved[1] + moved[2];
        const bool is_slow = std::fabs(moved[0]) <= most.speed_max * time + count;
        const bool is_soft =
            orders < 2 || std::fabs(second) <= most.acceleration_max * time * time + 2 * count;
        const bool is_smooth =
            orders < 3 || std::fabs(third) <= most.jerk_max * time * time * time + 4 * count;
        if (!(is_slow && is_soft && is_smooth)) {
            return false;
        }
    }
    return true;
}

bool LookAheadPath::extend(const PathPoints& points) noexcept {
    // Single periods show a jump; over a stride of 8, counts are 1/512 as large against the jerk.
    constexpr std::uint32_t kLongStride = 8;
    static_assert(3 * kLongStride < kPointsBehind);
    for (const bool is_before : {true, false}) {
        const std::uint64_t sample = is_before ? points.sample - 1 : points.sample;
        const bool is_known = holds(sample);
        if (!add(sample, is_before ? points.before : points.position)) {
            return false;
        }
        if (is_known || !holds(sample)) {
            continue;
        }
        for (const std::uint32_t stride : {1U, point(sample).gap, kLongStride}) {
            if (!is_possible(sample, stride)) {
                return false;
            }
        }
    }
    return true;
}

bool LookAheadPath::note_path(const PathPoints& points) noexcept {
    if (extend(points)) {
        return true;
    }
    clear();
    if (!extend(points)) {  // the two points of this frame contradict the limits, too
        clear();
    }
    return false;
}

/// Largest distance of the path from the chord that ends at `sample`.
double LookAheadPath::bulge(std::uint32_t axis, std::uint64_t sample) const noexcept {
    const double time = point(sample).gap * period_s_ * kLongestPeriod;
    return machine_->axes[axis].acceleration_max * time * time / 8 * kUp;
}

/// Largest |q'| in the step that ends at `sample`, by the board's timer: its mean, plus the largest
/// change of speed in half of the chord's time.
double LookAheadPath::speed_in_step(std::uint32_t axis, std::uint64_t sample) const noexcept {
    const Axis& promised = machine_->axes[axis];
    const Point &to = point(sample), &from = point(sample - 1);
    const double count = options_.count[axis];
    const double moved = step(axis, from.position[axis], to.position[axis]);
    double acceleration = promised.acceleration_max * kLongestPeriod * kLongestPeriod;
    if (machine_->guard.free_jerk_limited && to.gap == 1 && from.gap == 1 && holds(sample - 2)) {
        // The second difference is a mean of the acceleration over two periods, centred on the
        // beginning of this step, so at most a period away from any instant of it.
        const double before = step(axis, point(sample - 2).position[axis], from.position[axis]);
        const double mean = (std::fabs(moved - before) + 2 * count) / (period_s_ * period_s_);
        const double jerk = promised.jerk_max * kLongestPeriod * kLongestPeriod * kLongestPeriod;
        acceleration = std::min(acceleration, mean + jerk * period_s_);
    }
    const double speed =
        (std::fabs(moved) + count) / period_s_ + 0.5 * acceleration * to.gap * period_s_;
    return std::min(speed, promised.speed_max * kLongestPeriod) * kUp;
}

/// First and last point between which the board latched a position, by its age.
LookAheadPath::Latched LookAheadPath::latched_at(std::uint64_t sample) const noexcept {
    const ValueAge age = machine_->can.latched_age;
    const std::uint32_t period_us = machine_->can.sample_us;
    const std::uint64_t most = (std::uint64_t{age.most_us} + period_us - 1) / period_us;
    return {sample - most, sample - age.least_us / period_us};  // no points before 0
}

/// Distance of a position from the chords between these points; 0 on them. NaN for NaN.
double LookAheadPath::off_path(std::uint32_t axis, double position,
                               const Latched& at) const noexcept {
    double off = step(axis, point(at.first).position[axis], position);  // unwrapped from here on
    double low = off, high = off;
    for (std::uint64_t sample = at.first + 1; sample <= at.last; ++sample) {
        off -= step(axis, point(sample - 1).position[axis], point(sample).position[axis]);
        low = std::min(low, off);
        high = std::max(high, off);
    }
    const double beyond = low > 0 ? low : -high;
    return low <= 0 && high >= 0 ? 0 : beyond;
}

bool LookAheadPath::keeps_to(const AxisSnapshot& snapshot) const noexcept {
    const Latched at = latched_at(snapshot.sample);
    if (!holds(at.first) || !holds(at.last)) {
        return true;
    }
    const bool has_neighbours = holds(at.first - 1) && holds(at.last + 1);
    // An error of the period shifts the instant that an age counts back to.
    const double loose_s =
        machine_->guard.latch_jitter_s + kPeriodShare * machine_->can.latched_age.most_us * 1e-6;
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        const Axis& axis = machine_->axes[i];
        double speed = has_neighbours ? 0 : axis.speed_max, bridge = 0;
        for (std::uint64_t k = at.first; has_neighbours && k <= at.last + 1; ++k) {
            speed = std::max(speed, speed_in_step(i, k));
        }
        for (std::uint64_t k = at.first; k <= at.last; ++k) {
            const bool is_on_chord = k > at.first || point(k).is_bridge;
            bridge = is_on_chord ? std::max(bridge, bulge(i, k)) : bridge;
        }
        // Includes half a count of either frame, and the error of a position on the wire.
        const double allowed = axis.following_error + axis.position_error + options_.count[i] +
                               speed * loose_s + bridge + kPositionUp;
        if (!(off_path(i, snapshot.position[i], at) <= allowed)) {
            return false;
        }
    }
    return true;
}

PathStretch LookAheadPath::stretch(std::uint64_t sample, double free_s) const noexcept {
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
        const double end_s = free_s + path_braking_s(most.deceleration, most.jerk);
        const double periods = end_s / period_s_ * kUp;
        if (periods <= static_cast<double>(at - sample)) {
            return {true, periods};
        }
    }
    return out;
}

void LookAheadPath::cut(std::uint64_t sample, double end,
                        std::span<JointBox, kPathPieces> out) const noexcept {
    AXG_ASSERT(holds(sample) && end >= 0);
    constexpr std::uint32_t kFirstLeaf = kPathLeaves - 1;
    std::array<double, kAxesMax> from = at(sample), low, high;  // unwrapped from here on
    std::uint64_t ahead = 1;                                    // the step that contains `from`
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
    join(out);
}

/// Sets each parent to enclose its children; the leaves are at the end.
void LookAheadPath::join(std::span<JointBox> pieces) const noexcept {
    for (std::size_t node = pieces.size() / 2; node-- > 0;) {
        const JointBox &a = pieces[2 * node + 1], &b = pieces[2 * node + 2];
        pieces[node] = {};
        for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
            const double least = std::min(a.centre[i] - a.half[i], b.centre[i] - b.half[i]);
            const double most = std::max(a.centre[i] + a.half[i], b.centre[i] + b.half[i]);
            pieces[node].centre[i] = 0.5 * (least + most);
            pieces[node].half[i] = 0.5 * (most - least) * kUp + kPositionUp;
        }
    }
}

bool LookAheadPath::is_middle(std::uint64_t sample) const noexcept {
    if (sample < 2 || !holds(sample - 2) || !holds(sample + 2)) {
        return false;
    }
    bool is_sent = true;
    for (std::uint64_t k = sample - 1; k <= sample + 2 && is_sent; ++k) {
        is_sent = point(k).gap == 1;
    }
    return is_sent;
}

/// The points with the tightest bounds for the step that ends at `sample`: its beginning or, if
/// frames near it were lost, the nearest on either side.
LookAheadPath::Middles LookAheadPath::middles_about(std::uint64_t sample) const noexcept {
    Middles out;
    const auto take = [&](std::uint64_t middle) {
        const bool is_one = is_middle(middle);
        if (is_one) {
            out.sample[out.count++] = middle;
        }
        return is_one;
    };
    if (take(sample - 1)) {
        return out;
    }
    for (std::uint64_t k = 2; k <= kMiddlesMost && sample >= k && !take(sample - k); ++k) {
    }
    for (std::uint64_t k = 0; k < kMiddlesMost && !take(sample + k); ++k) {
    }
    return out;
}

/// Bounds a mean of the acceleration, weighted by a hat of two periods either way around `middle`:
/// the second difference.
LookAheadPath::Span LookAheadPath::mean_acceleration(std::uint32_t axis,
                                                     std::uint64_t middle) const noexcept {
    const double moved = step(axis, point(middle).position[axis], point(middle + 2).position[axis]),
                 before =
                     step(axis, point(middle - 2).position[axis], point(middle).position[axis]);
    const double square = 4 * period_s_ * period_s_, count = 2 * options_.count[axis];
    const auto stretched = [square](double second_difference) {  // by the error of the period
        constexpr double kShort = (1 - kPeriodShare) * (1 - kPeriodShare),
                         kLong = (1 + kPeriodShare) * (1 + kPeriodShare);
        return Span{second_difference / (square * (second_difference < 0 ? kShort : kLong)),
                    second_difference / (square * (second_difference < 0 ? kLong : kShort))};
    };
    return {stretched(moved - before - count).low, stretched(moved - before + count).high};
}

/// Acceleration of the axis itself in the chord that contains the step ending at `sample`.
LookAheadPath::Span LookAheadPath::acceleration_in_step(std::uint32_t axis, std::uint64_t sample,
                                                        const Middles& middles) const noexcept {
    const Axis& promised = machine_->axes[axis];
    const double a = promised.acceleration_max;
    Span out{-a, a};
    if (!machine_->guard.free_jerk_limited) {
        return out;
    }
    const double gap = point(sample).gap;  // the chord ends or began at most a gap away
    for (std::uint32_t i = 0; i < middles.count; ++i) {
        const double after = static_cast<double>(sample) - static_cast<double>(middles.sample[i]);
        const double away = std::max(std::fabs(after + gap - 1), std::fabs(after - gap));
        // The hat's mean distance from an instant one period or more from its middle exceeds the
        // distance of the middle by at most 0.3 periods.
        const double drift =
            (away + 0.3) * promised.jerk_max * period_s_ * kLongestPeriod + swing_[axis];
        const Span mean = mean_acceleration(axis, middles.sample[i]);
        const double low = mean.low - drift, high = mean.high + drift;
        out.low = std::max(out.low, low - kShareUp * std::fabs(low));
        out.high = std::min(out.high, high + kShareUp * std::fabs(high));
    }
    return out.low <= out.high ? out : Span{-a, a};  // contradiction: the axis broke its limits
}

/// Range of the axis between two instants of the step that ends at `sample`.
/// @param from, to  shares of the step
AxisRange LookAheadPath::range_in_step(std::uint32_t axis, std::uint64_t sample,
                                       const Middles& middles, double from,
                                       double to) const noexcept {
    const Axis& promised = machine_->axes[axis];
    const Point &begin = point(sample - 1), &end = point(sample);
    const double count = options_.count[axis], a = promised.acceleration_max;
    const double moved = step(axis, begin.position[axis], end.position[axis]);
    const double x = from * moved, y = to * moved;
    const double wide = bulge(axis, sample) + promised.following_error + 0.5 * count + kPositionUp;
    AxisRange out;
    out.low = std::min(x, y) - wide;
    out.high = std::max(x, y) + wide;
    const Span acceleration = acceleration_in_step(axis, sample, middles);
    const double most = std::max(std::fabs(acceleration.low), std::fabs(acceleration.high));
    // The axis is within the following error of the path, and their accelerations differ by at most
    // twice the largest: docs/theory/certificate.md, "Each axis by itself".
    const double off = 0.5 * most * end.gap * period_s_ * (1 + kPeriodShare) +
                       2 * std::sqrt(2 * a * promised.following_error);
    const double least = std::fabs(moved) - count, largest = std::fabs(moved) + count;
    const double slow = std::max(0.0, least) / (period_s_ * (1 + kPeriodShare)),
                 fast = largest / (period_s_ * (1 - kPeriodShare));
    const bool is_forward = moved >= 0;
    const double low = least > 0 ? slow : -fast;
    out.speed_low = (is_forward ? low : -fast) - off * kUp;
    out.speed_high = (is_forward ? fast : -low) + off * kUp;
    out.acceleration_low = acceleration.low;
    out.acceleration_high = acceleration.high;
    return out;
}

std::optional<AxisRange> LookAheadPath::end(std::uint32_t axis) const noexcept {
    if (is_empty_ || last_ - first_ < 2) {
        return std::nullopt;
    }
    AxisRange range = range_in_step(axis, last_ - 1, middles_about(last_ - 1), 1, 1);
    const double from = at(last_ - 2)[axis];
    range.low += from;
    range.high += from;
    return range;
}

AxisLimits LookAheadPath::limits_of(std::uint32_t axis) const noexcept {
    const Axis& promised = machine_->axes[axis];
    return {.speed_max = promised.speed_max,
            .acceleration_max = promised.acceleration_max,
            .jerk_max = promised.jerk_max,
            .stopping_min = promised.stopping_min,
            .stop_turns_round = machine_->guard.stop_reversal == StopReversal::jerk_limited};
}

bool LookAheadPath::reach(std::uint64_t sample, double free_s,
                          std::span<JointBox, kReachPieces> out) const noexcept {
    const double end = free_s / (period_s_ * (1 - kPeriodShare)) * kUp;
    const auto steps = static_cast<std::uint64_t>(std::ceil(end));
    if (!holds(sample) || !holds(sample + steps)) {
        return false;
    }
    const auto count = static_cast<std::uint32_t>(machine_->axes.size());
    std::array<double, kAxesMax> begin_at = at(sample);  // of the step, unwrapped
    std::uint64_t ahead = 1;
    for (std::uint32_t leaf = 0; leaf < kReachLeaves; ++leaf) {
        const double until = end * (leaf + 1) / kReachLeaves;
        double from = end * leaf / kReachLeaves;
        std::array<ReachRange, kAxesMax> ranges;
        ranges.fill({HUGE_VAL, -HUGE_VAL});
        while (from < until && ahead <= steps) {
            const double to = std::min(until, static_cast<double>(ahead));
            const double step_begin = static_cast<double>(ahead - 1);
            const Middles middles = middles_about(sample + ahead);
            for (std::uint32_t i = 0; i < count; ++i) {
                const AxisRange now =
                    range_in_step(i, sample + ahead, middles, from - step_begin, to - step_begin);
                const ReachRange range = stop_reach(limits_of(i), now, 0);
                ranges[i].low = std::min(ranges[i].low, begin_at[i] + range.low);
                ranges[i].high = std::max(ranges[i].high, begin_at[i] + range.high);
            }
            from = to;
            if (to >= static_cast<double>(ahead)) {
                for (std::uint32_t i = 0; i < count; ++i) {
                    begin_at[i] += step(i, point(sample + ahead - 1).position[i],
                                        point(sample + ahead).position[i]);
                }
                ++ahead;
            }
        }
        JointBox& box = out[kReachLeaves - 1 + leaf];
        box = {};
        for (std::uint32_t i = 0; i < count; ++i) {
            box.centre[i] = 0.5 * (ranges[i].low + ranges[i].high);
            box.half[i] = 0.5 * (ranges[i].high - ranges[i].low) * kUp + kPositionUp;
        }
    }
    join(out);
    return true;
}

}  // namespace axg
