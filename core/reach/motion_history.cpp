// SPDX-License-Identifier: Apache-2.0
#include "core/reach/motion_history.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/base/sincos.hpp"

namespace axg {

namespace {

constexpr double kShareUp = 0x1p-40;     // exceeds the roundings of any formula below
constexpr double kPositionUp = 0x1p-30;  // exceeds the roundings of positions up to 1e5
constexpr double kStrideS = 1e-3;        // closer samples yield loose acceleration bounds
constexpr double kLooseShare = 0.05;     // a larger share of jitter hides more than a count does

/// The promised limits of the axis.
struct Promised {
    double speed_max, acceleration_max, jerk_max;
    bool unlimited;
};

struct Span {
    double low, high;

    void meet(Span other) noexcept {
        low = std::max(low, other.low);
        high = std::min(high, other.high);
    }
};

Span widened(Span s) noexcept {
    return {s.low - kShareUp * std::fabs(s.low), s.high + kShareUp * std::fabs(s.high)};
}

/// Travel of the axis since an older snapshot, and bounds of the time it needed.
struct Since {
    double moved;
    Span time_s;
    double nominal_s;
};

/// False: the snapshot yields no bound.
bool since(const MotionHistory& h, std::uint32_t back, std::uint32_t axis, const Promised& promised,
           const SampleErrors& errors, Since& out) noexcept {
    const double nominal = static_cast<double>(h.sample[0] - h.sample[back]) * errors.period_s;
    out.nominal_s = nominal;
    out.time_s = {nominal * (1 - errors.period_share) - errors.latch_jitter_s,
                  nominal * (1 + errors.period_share) + errors.latch_jitter_s};
    out.moved = h.position[0][axis] - h.position[back][axis];
    if (promised.unlimited) {
        out.moved -= 2 * kPi * std::round(out.moved / (2 * kPi));
        // Beyond half a turn, the direction is ambiguous.
        if (!(promised.speed_max * out.time_s.high + 2 * errors.position < 0.99 * kPi)) {
            return false;
        }
    }
    return out.time_s.low > 0.25 * nominal;
}

/// Largest speed at the newest sample. Mirror the motion to get the smallest.
/// @param acceleration  upper bound at the newest sample
double speed_high(const Since& s, double acceleration, const Promised& promised,
                  const SampleErrors& errors) noexcept {
    const double far = s.moved + 2 * errors.position;
    double mean = far / s.time_s.low, late = 0;
    mean = std::max(mean, far / s.time_s.high);
    const double t = s.time_s.high, a = promised.acceleration_max;
    late = 0.5 * a * t;
    if (errors.is_jerk_limited) {
        const auto by_jerk = [&](double time) {
            return time * (0.5 * acceleration + promised.jerk_max * time / 6);
        };
        late = std::min(late, std::max(by_jerk(s.time_s.low), by_jerk(t)));
    }
    return mean + late;
}

Span speed_of(const MotionHistory& h, std::uint32_t axis, Span acceleration,
              const Promised& promised, const SampleErrors& errors) noexcept {
    Span out{-promised.speed_max, promised.speed_max};
    for (std::uint32_t i = 1; i < h.count; ++i) {
        Since s;
        if (!since(h, i, axis, promised, errors, s)) {
            continue;
        }
        Since mirrored = s;
        mirrored.moved = -s.moved;
        out.meet(widened({-speed_high(mirrored, -acceleration.low, promised, errors),
                          speed_high(s, acceleration.high, promised, errors)}));
    }
    return out;
}

/// Largest speed during these samples, and a jitter before and after. Within two strides the axis
/// had their mean speed at some instant; every other instant is at most their duration away.
double fastest_seen(const MotionHistory& h, std::uint32_t back, std::uint32_t axis,
                    const Promised& promised, const SampleErrors& errors) noexcept {
    double fastest = 0;
    for (std::uint32_t newer = 0; newer < back; newer += 2) {
        const std::uint32_t older = std::min(newer + 2, back);
        const double nominal =
            static_cast<double>(h.sample[newer] - h.sample[older]) * errors.period_s;
        const double shortest = nominal * (1 - errors.period_share) - errors.latch_jitter_s;
        const double longest = nominal * (1 + errors.period_share) + errors.latch_jitter_s;
        double moved = h.position[newer][axis] - h.position[older][axis];
        moved -= promised.unlimited ? 2 * kPi * std::round(moved / (2 * kPi)) : 0;
        if (!(shortest > 0.25 * nominal)) {
            return promised.speed_max;
        }
        fastest = std::max(fastest, (std::fabs(moved) + 2 * errors.position) / shortest +
                                        promised.acceleration_max * longest);
    }
    return fastest + promised.acceleration_max * errors.latch_jitter_s;
}

/// Bounds from three samples: the second divided difference is a mean of the acceleration.
Span acceleration_from(const Since& one, const Since& two, double fastest, const Promised& promised,
                       const SampleErrors& errors) noexcept {
    const double d1 = one.nominal_s, d2 = two.nominal_s, between = d2 - d1;
    const double mean = 2 * (one.moved / d1 - (two.moved - one.moved) / between) / d2;
    // Counts an error of the latch instant as an error of the position.
    const double speed = std::min(promised.speed_max, fastest);
    const double older = errors.position + speed * errors.latch_jitter_s;
    const double off =
        2 / d2 * (errors.position / d1 + older * (1 / d1 + 1 / between) + older / between);
    const double drift = promised.jerk_max * (one.time_s.high + two.time_s.high) / 3;
    // One period error scales d1 and d2 alike by up to the share, and the mean by its square.
    const double scale_low = 1 / ((1 + errors.period_share) * (1 + errors.period_share));
    const double scale_high = 1 / ((1 - errors.period_share) * (1 - errors.period_share));
    const double low = mean - off, high = mean + off;
    return {low * (low > 0 ? scale_low : scale_high) - drift,
            high * (high > 0 ? scale_high : scale_low) + drift};
}

Span acceleration_of(const MotionHistory& h, std::uint32_t axis, double fastest,
                     const Promised& promised, const SampleErrors& errors) noexcept {
    Span out{-promised.acceleration_max, promised.acceleration_max};
    for (std::uint32_t i = 1; errors.is_jerk_limited && 2 * i < h.count; ++i) {
        Since one, two;
        if (since(h, i, axis, promised, errors, one) &&
            since(h, 2 * i, axis, promised, errors, two)) {
            double most = fastest + promised.acceleration_max * two.time_s.high;
            if (errors.latch_jitter_s > kLooseShare * one.nominal_s) {
                most = std::min(most, fastest_seen(h, 2 * i, axis, promised, errors));
            }
            out.meet(widened(acceleration_from(one, two, most, promised, errors)));
        }
    }
    return out;
}

}  // namespace

void note_snapshot(MotionHistory& history, const AxisSnapshot& snapshot,
                   std::uint32_t stride) noexcept {
    MotionHistory& h = history;
    if (h.count > 0 && snapshot.sample <= h.sample[0]) {
        h.count = 0;
    }
    const bool replaces = h.count > 1 && h.sample[0] - h.sample[1] < stride;
    if (!replaces) {
        h.count = std::min(h.count + 1, kSamplesKept);
        for (std::uint32_t i = h.count - 1; i > 0; --i) {
            h.sample[i] = h.sample[i - 1];
            h.position[i] = h.position[i - 1];
        }
    }
    h.sample[0] = snapshot.sample;
    h.position[0] = snapshot.position;
}

std::uint32_t history_stride(double period_s) noexcept {
    return static_cast<std::uint32_t>(std::max(1.0, std::round(kStrideS / period_s)));
}

RangeFinding find_range(const MotionHistory& history, std::uint32_t axis, const AxisLimits& limits,
                        bool is_unlimited, const SampleErrors& errors) noexcept {
    AXG_ASSERT(history.count > 0);
    const Promised promised{limits.speed_max, limits.acceleration_max, limits.jerk_max,
                            is_unlimited};
    SampleErrors e = errors;
    e.position += kPositionUp;
    const double at = history.position[0][axis];
    const Span any{-promised.acceleration_max, promised.acceleration_max};
    Span speed = speed_of(history, axis, any, promised, e);
    const double fastest = std::max(std::fabs(speed.low), std::fabs(speed.high));
    const Span acceleration = acceleration_of(history, axis, fastest, promised, e);
    if (e.is_jerk_limited) {
        speed.meet(speed_of(history, axis, acceleration, promised, e));
    }
    RangeFinding out{.range = {at - e.position, at + e.position, speed.low, speed.high,
                               acceleration.low, acceleration.high}};
    if (!(speed.low <= speed.high && acceleration.low <= acceleration.high)) {
        out.speed_gap = std::max(0.0, speed.low - speed.high);
        out.acceleration_gap = std::max(0.0, acceleration.low - acceleration.high);
        out.range.speed_low = -promised.speed_max;
        out.range.speed_high = promised.speed_max;
        out.range.acceleration_low = -promised.acceleration_max;
        out.range.acceleration_high = promised.acceleration_max;
    }
    return out;
}

AxisRange range_of(const MotionHistory& history, std::uint32_t axis, const Axis& promised,
                   const SampleErrors& errors) noexcept {
    const AxisLimits limits{.speed_max = promised.speed_max,
                            .acceleration_max = promised.acceleration_max,
                            .jerk_max = promised.jerk_max};
    return find_range(history, axis, limits, promised.unlimited, errors).range;
}

}  // namespace axg
