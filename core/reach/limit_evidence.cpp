// SPDX-License-Identifier: Apache-2.0
#include "core/reach/limit_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/base/sincos.hpp"
#include "core/reach/stop_limits.hpp"

namespace axg {
namespace {

constexpr double kUp = 1 + 0x1p-40;      // exceeds the roundings of any formula below
constexpr double kPositionUp = 0x1p-30;  // exceeds the roundings of positions up to 1e5

// Rest after a stop: 16 strides by the board's contract (docs/theory/certificate.md), of which
// three samples may be lost and one is partial.
constexpr std::uint64_t kRestStrides = 12, kRestPointsMin = 9;
constexpr std::uint64_t kRestStridesPromised = 16;

constexpr double kStopStridesMax = 1e6;

constexpr std::uint64_t kNever = ~std::uint64_t{0};

/// Travel of an axis over up to three equal times, newest first.
struct Steps {
    std::uint32_t count = 0;
    std::array<double, 3> moved{};

    [[nodiscard]] double second() const noexcept { return moved[0] - moved[1]; }
    [[nodiscard]] double third() const noexcept { return moved[0] - 2 * moved[1] + moved[2]; }
};

double short_way(const AxisLimitRules& axis, double moved) noexcept {
    return axis.unlimited ? moved - 2 * kPi * std::round(moved / (2 * kPi)) : moved;
}

double position_error(const AxisLimitRules& axis) noexcept {
    return axis.errors.position + kPositionUp;
}

/// Position error, with the latch jitter as an error: half the jitter against a shifted time grid.
double error_at(const AxisLimitRules& axis, double speed) noexcept {
    return position_error(axis) + 0.5 * speed * axis.errors.latch_jitter_s;
}

double error_at_most(const AxisLimitRules& axis) noexcept {
    return error_at(axis, axis.limits.speed_max);
}

double nominal_s(const LimitRules& rules, const AxisLimitRules& axis,
                 std::uint32_t strides) noexcept {
    return strides * rules.stride * axis.errors.period_s;
}

const double* point_at(const LimitWatch& watch, std::uint64_t stride) noexcept {
    const std::uint64_t place = stride % kLimitPoints;
    return watch.stride[place] == stride + 1 ? watch.position[place].data() : nullptr;
}

Steps steps_of(const LimitWatch& watch, const LimitRules& rules, std::uint32_t axis,
               std::uint32_t strides) noexcept {
    const AxisLimitRules& of = rules.axes[axis];
    const double longest_s = nominal_s(rules, of, strides) * (1 + of.errors.period_share);
    Steps out;
    if (of.unlimited && !(of.limits.speed_max * longest_s + 2 * error_at_most(of) < 0.99 * kPi)) {
        return out;  // beyond half a turn, the direction is ambiguous
    }
    const double* newer = point_at(watch, watch.newest);
    for (std::uint64_t back = strides; out.count < 3 && back <= watch.newest; back += strides) {
        const double* older = point_at(watch, watch.newest - back);
        if (newer == nullptr || older == nullptr) {
            break;
        }
        out.moved[out.count++] = short_way(of, newer[axis] - older[axis]);
        newer = older;
    }
    return out;
}

/// Largest speed anywhere in these steps, for an axis within its limits.
double speed_seen(const AxisLimitRules& axis, const Steps& steps, double nominal) noexcept {
    const double shortest_s = nominal * (1 - axis.errors.period_share) - axis.errors.latch_jitter_s;
    const double longest_s = nominal * (1 + axis.errors.period_share) + axis.errors.latch_jitter_s;
    if (!(shortest_s > 0.25 * nominal)) {
        return axis.limits.speed_max;
    }
    double farthest = 0;
    for (std::uint32_t i = 0; i < steps.count; ++i) {
        farthest = std::max(farthest, std::fabs(steps.moved[i]));
    }
    const double mean = (farthest + 2 * position_error(axis)) / shortest_s;
    return std::min(axis.limits.speed_max, mean + axis.limits.acceleration_max * longest_s);
}

/// The least values that explain these steps: a difference is a power of the time, times a mean.
LimitFigures figures_of(const LimitRules& rules, const AxisLimitRules& axis, const Steps& steps,
                        std::uint32_t strides) noexcept {
    LimitFigures out;
    if (steps.count == 0) {
        return out;
    }
    const double nominal = nominal_s(rules, axis, strides);
    const double h = nominal * (1 + axis.errors.period_share);
    const auto beyond = [](double difference, double hidden, double time) {
        return std::max(0.0, std::fabs(difference) - hidden) / time;
    };
    if (strides == kLimitStrides.back()) {
        out.seen_speed = std::fabs(steps.moved[0]) / nominal;
        out.seen_acceleration =
            steps.count > 1 ? std::fabs(steps.second()) / (nominal * nominal) : 0;
    }
    const DifferenceWeights& weights = rules.weights;
    out.speed = beyond(steps.moved[0], weights.speed * error_at_most(axis), h);
    const double error = error_at(axis, speed_seen(axis, steps, nominal));
    if (steps.count > 1) {
        out.acceleration = beyond(steps.second(), weights.acceleration * error, h * h);
    }
    if (steps.count > 2) {
        out.jerk = beyond(steps.third(), weights.jerk * error, h * h * h);
    }
    return out;
}

/// Whether the newest step may be in this direction. The axis may have reversed before a stop.
bool may_go(const Steps& steps, double way, double error) noexcept {
    return steps.moved[0] * way >= -2 * error;
}

/// Whether the acceleration may be against the motion.
bool may_brake(const Steps& steps, double error) noexcept {
    return may_go(steps, steps.second() < 0 ? 1 : -1, error);
}

/// Whether the jerk may be against the motion, or the speed may be falling.
bool may_begin_braking(const Steps& steps, double error) noexcept {
    for (const double way : {1.0, -1.0}) {
        const bool is_against = steps.third() * way < 0;
        const bool falls = steps.second() * way <= 4 * error && steps.moved[1] * way >= -2 * error;
        if (may_go(steps, way, error) && (is_against || falls)) {
            return true;
        }
    }
    return false;
}

/// Updates the newest position and the travel since the stop began.
void follow_position(OwnStop& stop, const AxisLimitRules& of, double position) noexcept {
    stop.moved += short_way(of, position - stop.last);
    stop.last = position;
}

AxisRange whole_range(const AxisLimitRules& of) noexcept {
    AxisRange range;
    range.speed_low = -of.limits.speed_max;
    range.speed_high = of.limits.speed_max;
    range.acceleration_low = -of.limits.acceleration_max;
    range.acceleration_high = of.limits.acceleration_max;
    return range;
}

/// Sets the state before the stop: `span` strides ago or, if that point is lost, earlier.
void look_back(OwnStop& stop, const LimitWatch& watch, const AxisLimitRules& of, std::uint32_t axis,
               std::uint64_t span) noexcept {
    stop.start = watch.newest;
    stop.before = whole_range(of);
    stop.last = point_at(watch, watch.newest)[axis];
    for (std::uint64_t back = span; back < std::min<std::uint64_t>(kLimitPoints, watch.newest + 1);
         ++back) {
        const std::uint64_t start = watch.newest - back;
        const double* const point = point_at(watch, start);
        if (point == nullptr) {
            continue;
        }
        stop.start = start;
        stop.before = watch.believed[start % kLimitPoints][axis];
        stop.last = point[axis];
        break;
    }
    for (std::uint64_t stride = stop.start + 1; stride <= watch.newest; ++stride) {
        if (const double* const point = point_at(watch, stride); point != nullptr) {
            follow_position(stop, of, point[axis]);
        }
    }
}

/// Largest travel of free motion in one direction: each term is a bound.
double free_way(const AxisLimitRules& of, double speed, double acceleration, double t) noexcept {
    const double v = std::max(0.0, speed), a = std::max(0.0, acceleration);
    const double by_jerk = of.errors.is_jerk_limited
                               ? v * t + 0.5 * a * t * t + of.limits.jerk_max * t * t * t / 6
                               : INFINITY;
    const double by_acceleration = v * t + 0.5 * of.limits.acceleration_max * t * t;
    return std::min({by_jerk, by_acceleration, of.limits.speed_max * t});
}

/// Whether no motion within these limits leads from the stop's start to the newest position, with
/// any deceleration on the way.
bool is_too_far(const OwnStop& stop, const LimitRules& rules, const AxisLimitRules& of,
                std::uint64_t now) noexcept {
    const double t = nominal_s(rules, of, static_cast<std::uint32_t>(now - stop.start)) *
                     (1 + of.errors.period_share);
    const double hidden = 2 * error_at_most(of);
    const AxisRange& before = stop.before;
    return stop.moved > free_way(of, before.speed_high, before.acceleration_high, t) + hidden ||
           -stop.moved > free_way(of, -before.speed_low, -before.acceleration_low, t) + hidden;
}

/// Begins a stop of the axis. False: the board is not allowed to make a harder stop.
/// @param span  strides of the points that show it: no stop began before the first of them
bool begin_stop(LimitWatch& watch, const LimitRules& rules, const LimitFact& cause,
                std::uint64_t falls_from, std::uint64_t span) noexcept {
    const AxisLimitRules& of = rules.axes[cause.axis];
    OwnStop& stop = watch.stops[cause.axis];
    if (of.stop_strides == 0) {
        return false;
    }
    if (!stop.is_on) {
        stop = {};
        stop.is_on = true;
        stop.begin = watch.newest;
        stop.falls_from = falls_from;
        stop.cause = cause;
        stop.step_max.fill(INFINITY);
        look_back(stop, watch, of, cause.axis, span);
    }
    stop.falls_from = std::min(stop.falls_from, falls_from);
    begin_machine_stop(watch.machine_stop, cause, watch.newest);
    return true;
}

/// Whether position errors alone explain the differences of all points of the last strides.
bool is_at_rest(const LimitWatch& watch, const AxisLimitRules& of, std::uint32_t axis) noexcept {
    const double* newest = point_at(watch, watch.newest);
    double low = 0, high = 0;
    std::uint64_t seen = 0;
    for (std::uint64_t back = 0; back <= std::min(kRestStrides, watch.newest); ++back) {
        const double* older = point_at(watch, watch.newest - back);
        if (older != nullptr) {
            const double off = short_way(of, older[axis] - newest[axis]);
            low = std::min(low, off);
            high = std::max(high, off);
            ++seen;
        }
    }
    return seen > kRestPointsMin && high - low <= 2 * position_error(of);
}

MachineRest rest_of(const LimitWatch& watch, const LimitRules& rules) noexcept {
    MachineRest out{.is_any_stopping = false, .are_all_at_rest = true};
    for (std::uint32_t i = 0; watch.machine_stop.is_on && i < rules.axis_count; ++i) {
        out.is_any_stopping = out.is_any_stopping || watch.stops[i].is_on;
        out.are_all_at_rest = out.are_all_at_rest && is_at_rest(watch, rules.axes[i], i);
    }
    return out;
}

/// Checks that the speed falls and rest follows in time. Otherwise returns the stop's cause.
LimitFact follow_stop(LimitWatch& watch, const LimitRules& rules, std::uint32_t axis) noexcept {
    OwnStop& stop = watch.stops[axis];
    const AxisLimitRules& of = rules.axes[axis];
    const std::uint64_t now = watch.newest;
    if (!stop.is_on) {
        return {};
    }
    if (stop.begin != now) {
        follow_position(stop, of, point_at(watch, now)[axis]);
    }
    // With `path_keeping`, other axes may force one beyond its own limits in a stop. The direction
    // of an endless axis is uncertain if its step may reach half a turn.
    const double stride_s = nominal_s(rules, of, 4);
    const bool is_followed =
        !rules.stops_keep_path && !(of.unlimited && of.limits.speed_max * stride_s > 0.9 * kPi);
    if (is_followed && is_too_far(stop, rules, of, now)) {
        return stop.cause;
    }
    if (is_at_rest(watch, of, axis)) {
        stop = {};
        watch.judged_from[axis] = now - std::min(kRestStrides, now);
        return {};
    }
    for (std::size_t i = 0; i < kLimitStrides.size(); ++i) {
        const Steps steps = steps_of(watch, rules, axis, kLimitStrides[i]);
        if (steps.count == 0 || now - kLimitStrides[i] < stop.falls_from) {
            continue;
        }
        const double step = std::fabs(steps.moved[0]);
        if (step > stop.step_max[i] + 4 * error_at_most(of)) {
            return stop.cause;
        }
        stop.step_max[i] = std::min(stop.step_max[i], step);
    }
    const std::uint64_t rests_by = stop.begin + of.stop_strides + kRestStridesPromised;
    return now > rests_by ? stop.cause : LimitFact{};
}

/// Checks for contradicting bounds of speed or acceleration: an excess that no single difference
/// shows.
LimitFact judge_ranges(LimitWatch& watch, const LimitRules& rules, const MotionHistory& history,
                       std::uint32_t axis) noexcept {
    if (!ranges_hold(watch, rules, history, axis)) {
        return {};
    }
    const AxisLimitRules& of = rules.axes[axis];
    const RangeFinding& found = watch.ranges[axis];
    if (found.speed_gap == 0 && found.acceleration_gap == 0) {
        return {};
    }
    const bool is_speed = found.speed_gap > 0;
    const LimitFact fact{.kind = is_speed ? LimitKind::speed_range : LimitKind::acceleration_range,
                         .axis = axis,
                         .measured = is_speed ? found.speed_gap : found.acceleration_gap,
                         .sample = history.sample[0]};
    const std::uint64_t ramp = of.errors.is_jerk_limited ? of.ramp_strides : 0;
    const std::uint64_t falls_from = rules.stops_keep_path ? kNever : watch.newest + ramp;
    return begin_stop(watch, rules, fact, falls_from, kSamplesKept) ? LimitFact{} : fact;
}

/// Checks an unchanged count: the true position is within the errors of it at both ends. From a
/// speed of at least s, an axis within its acceleration moves at least s t - a t^2 / 2.
LimitFact judge_resting_count(LimitWatch& watch, const LimitRules& rules, std::uint32_t axis,
                              std::uint64_t sample) noexcept {
    const AxisLimitRules& of = rules.axes[axis];
    RestingCount& resting = watch.resting[axis];
    const double position = point_at(watch, watch.newest)[axis];
    if (watch.newest == resting.since || position != resting.position) {
        resting = {.since = watch.newest, .position = position};
        return {};
    }
    const double nominal =
        nominal_s(rules, of, static_cast<std::uint32_t>(watch.newest - resting.since));
    const double shortest_s = nominal * (1 - of.errors.period_share) - of.errors.latch_jitter_s;
    const double longest_s = nominal * (1 + of.errors.period_share) + of.errors.latch_jitter_s;
    const bool may_have_turned =
        of.unlimited && !(of.limits.speed_max * longest_s + 2 * position_error(of) < 0.99 * kPi);
    const auto way = [&](double t) {
        return resting.speed * t - 0.5 * of.limits.acceleration_max * t * t;
    };
    const double least = std::min(way(shortest_s), way(longest_s));  // concave: at an end
    if (watch.stops[axis].is_on || may_have_turned || !(shortest_s > 0) ||
        !(least > 2 * position_error(of) * kUp)) {
        return {};
    }
    const LimitFact frozen{LimitKind::frozen_axis, axis, resting.speed, 0, sample};
    const std::uint64_t falls_from = rules.stops_keep_path ? kNever : watch.newest;
    return begin_stop(watch, rules, frozen, falls_from, watch.newest - resting.since) ? LimitFact{}
                                                                                      : frozen;
}

/// Stores the least speed of an axis, either way, if its count begins to rest at this stride.
void note_resting_speed(LimitWatch& watch, std::uint32_t axis) noexcept {
    const AxisRange& range = watch.believed[watch.newest % kLimitPoints][axis];
    if (watch.resting[axis].since == watch.newest) {
        watch.resting[axis].speed = std::max({0.0, range.speed_low, -range.speed_high});
    }
}

LimitFact judge_differences(LimitWatch& watch, const LimitRules& rules, std::uint32_t axis,
                            std::uint64_t sample) noexcept {
    const AxisLimitRules& of = rules.axes[axis];
    OwnStop& stop = watch.stops[axis];
    const std::uint64_t now = watch.newest;
    const double error = error_at_most(of);
    const auto fact = [&](LimitKind kind, double measured, double declared) {
        return LimitFact{kind, axis, measured, declared, sample};
    };
    const bool any_way = rules.stops_keep_path;
    const auto falls_after = [&](std::uint64_t strides) {
        return any_way ? kNever : now + strides;
    };
    for (const std::uint32_t strides : kLimitStrides) {
        const Steps steps = steps_of(watch, rules, axis, strides);
        const LimitFigures figures = figures_of(rules, of, steps, strides);
        if (figures.speed > of.limits.speed_max * kUp) {
            return fact(LimitKind::speed, figures.speed, of.limits.speed_max);
        }
        const auto is_judged = [&](std::uint32_t count) {
            return steps.count >= count &&
                   now - std::uint64_t{count} * strides >= watch.judged_from[axis];
        };
        if (is_judged(2) && figures.acceleration > of.limits.acceleration_max * kUp) {
            const LimitFact broken =
                fact(LimitKind::acceleration, figures.acceleration, of.limits.acceleration_max);
            if (!(any_way || may_brake(steps, error)) ||
                !begin_stop(watch, rules, broken, falls_after(0), std::uint64_t{2} * strides)) {
                return broken;
            }
            if (figures.acceleration > of.stopping_most * kUp) {
                begin_machine_stop(
                    watch.machine_stop,
                    fact(LimitKind::stopping, figures.acceleration, of.stopping_most), now);
            }
        }
        if (is_judged(3) && !stop.is_on && of.errors.is_jerk_limited &&
            figures.jerk > of.limits.jerk_max * kUp) {
            const LimitFact broken = fact(LimitKind::jerk, figures.jerk, of.limits.jerk_max);
            if (!(any_way || may_begin_braking(steps, error)) ||
                !begin_stop(watch, rules, broken, falls_after(of.ramp_strides),
                            std::uint64_t{3} * strides)) {
                return broken;
            }
        }
    }
    return {};
}

}  // namespace

LimitRules limit_rules(const Machine& machine, std::span<const double> count) noexcept {
    AXG_ASSERT(count.size() >= machine.axes.size());
    LimitRules out;
    const double period_s = machine.can.sample_us * 1e-6;
    out.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    out.stride = history_stride(period_s);
    // Converts seconds to strides of a board with a fast clock.
    const double stride_s = out.stride * period_s * (1 - kPeriodShare);
    const auto strides = [&](double seconds) {
        return 1 +
               static_cast<std::uint64_t>(std::ceil(std::min(kStopStridesMax, seconds / stride_s)));
    };
    double ramp_most_s = 0, braking_most_s = 0;
    for (std::uint32_t i = 0; i < out.axis_count; ++i) {
        AxisLimitRules& axis = out.axes[i];
        axis.limits = stop_limits(machine, i);
        axis.errors = sample_errors(machine, i, count[i]);
        axis.unlimited = machine.axes[i].unlimited;
        // The softest stop: jerk-limited from the largest acceleration to the guaranteed
        // deceleration, then at that deceleration to rest.
        const AxisLimits& l = axis.limits;
        const double ramp_s = l.acceleration_max / l.jerk_max;
        axis.ramp_strides = strides(ramp_s);
        const double full_ramp_s = ramp_s + l.stopping_min / l.jerk_max;
        const double braking_s = l.speed_max / l.stopping_min;
        axis.stop_strides = strides(full_ramp_s + braking_s);
        ramp_most_s = std::max(ramp_most_s, full_ramp_s);
        braking_most_s = std::max(braking_most_s, braking_s);
    }
    // Axes that stop along one path rest together, after 1/R + R/J. Each term is at most the
    // largest of all axes.
    out.stops_keep_path = machine.guard.promise == StopPromise::path_keeping;
    for (std::uint32_t i = 0; i < out.axis_count; ++i) {
        AxisLimitRules& axis = out.axes[i];
        if (out.stops_keep_path) {
            axis.stop_strides = strides(ramp_most_s + braking_most_s);
        } else {
            axis.stopping_most = machine.axes[i].stopping_most;
        }
        out.machine_stop.braking_strides =
            std::max(out.machine_stop.braking_strides, axis.stop_strides);
    }
    out.machine_stop.stops_all = is_native(machine.can);
    out.machine_stop.reaction_strides =
        strides(free_seconds(machine, machine.can.permit_samples.most));
    return out;
}

void forget_limits(LimitWatch& watch) noexcept {
    watch = {};
}

LimitFact note_limits(LimitWatch& watch, const LimitRules& rules, const AxisSnapshot& snapshot,
                      const MotionHistory& history) noexcept {
    const std::uint64_t stride = snapshot.sample / rules.stride;
    if (stride < watch.newest) {
        forget_limits(watch);
    }
    for (std::uint32_t i = 0; i < rules.axis_count; ++i) {
        const AxisLimitRules& of = rules.axes[i];
        watch.ranges[i] = find_range(history, i, of.limits, of.unlimited, of.errors);
    }
    if (snapshot.sample % rules.stride != 0) {
        return {};
    }
    watch.newest = stride;
    watch.stride[stride % kLimitPoints] = stride + 1;
    watch.position[stride % kLimitPoints] = snapshot.position;
    LimitFact out;
    for (std::uint32_t i = 0; i < rules.axis_count; ++i) {
        LimitFact fact = judge_resting_count(watch, rules, i, snapshot.sample);
        fact = fact.kind == LimitKind::none ? judge_differences(watch, rules, i, snapshot.sample)
                                            : fact;
        fact = fact.kind == LimitKind::none ? judge_ranges(watch, rules, history, i) : fact;
        fact = fact.kind == LimitKind::none ? follow_stop(watch, rules, i) : fact;
        out = out.kind == LimitKind::none ? fact : out;
        watch.believed[stride % kLimitPoints][i] = ranges_hold(watch, rules, history, i)
                                                       ? watch.ranges[i].range
                                                       : whole_range(rules.axes[i]);
        note_resting_speed(watch, i);
    }
    const LimitFact overdue =
        follow_machine_stop(watch.machine_stop, rules.machine_stop, rest_of(watch, rules), stride);
    return out.kind == LimitKind::none ? overdue : out;
}

bool ranges_hold(const LimitWatch& watch, const LimitRules& rules, const MotionHistory& history,
                 std::uint32_t axis) noexcept {
    return !watch.stops[axis].is_on && history.count > 0 &&
           history.sample[history.count - 1] >= watch.judged_from[axis] * rules.stride;
}

double blind_speed(const LimitRules& rules, std::uint32_t axis) noexcept {
    const AxisLimitRules& of = rules.axes[axis];
    const double a = of.limits.acceleration_max, jitter = of.errors.latch_jitter_s;
    double least = INFINITY;
    for (const std::uint32_t strides : kLimitStrides) {
        const double nominal = nominal_s(rules, of, strides);
        const double shortest = nominal * (1 - of.errors.period_share);
        const double longest = nominal * (1 + of.errors.period_share);
        const bool may_have_turned =
            of.unlimited && !(of.limits.speed_max * longest + 2 * error_at_most(of) < 0.99 * kPi);
        // A step that ends at v is at least v h - a h^2 / 2 long, and the next one is 0:
        // v shortest > 1.5 a longest^2 + 4 (e + (v + a longest) jitter / 2).
        const double room = shortest - rules.weights.acceleration * 0.5 * jitter;
        const double hidden =
            rules.weights.acceleration * (position_error(of) + 0.5 * a * longest * jitter);
        if (!may_have_turned && room > 0) {
            least = std::min(least, (1.5 * a * longest * longest + hidden) / room);
        }
    }
    return least;
}

LimitFigures measure_limits(const LimitWatch& watch, const LimitRules& rules,
                            std::uint32_t axis) noexcept {
    LimitFigures out;
    for (const std::uint32_t strides : kLimitStrides) {
        const LimitFigures figures =
            figures_of(rules, rules.axes[axis], steps_of(watch, rules, axis, strides), strides);
        out.speed = std::max(out.speed, figures.speed);
        out.acceleration = std::max(out.acceleration, figures.acceleration);
        out.jerk = std::max(out.jerk, figures.jerk);
        out.seen_speed = std::max(out.seen_speed, figures.seen_speed);
        out.seen_acceleration = std::max(out.seen_acceleration, figures.seen_acceleration);
    }
    return out;
}

}  // namespace axg
