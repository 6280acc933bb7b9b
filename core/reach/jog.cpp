// SPDX-License-Identifier: Apache-2.0
#include "core/reach/jog.hpp"

#include <cmath>

#include "core/base/sincos.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {

JogMove jog_of(const AxisSnapshot& snapshot) noexcept {
    if (snapshot.mode != kModeJog) {
        return {};
    }
    return {static_cast<std::uint32_t>(snapshot.flags >> kJogAxisShift),
            (snapshot.flags & kFlagJogNegative) != 0};
}

void put_jog(const JogMove& move, AxisSnapshot& snapshot) noexcept {
    snapshot.mode = kModeJog;
    snapshot.flags = static_cast<std::uint8_t>((snapshot.flags & kFlagNotHomed) |
                                               (move.is_negative ? kFlagJogNegative : 0U) |
                                               (move.axis << kJogAxisShift));
}

std::array<double, kJogRungs> jog_ladder(double margin_mm, double before_mm) noexcept {
    constexpr std::uint32_t kHalf = kJogRungs / 2;
    const double low = std::max(0.0, std::min(before_mm, margin_mm));
    const double fine = std::min(kJogRungMm, (margin_mm - low) / kJogRungs);
    const double coarse = (margin_mm - low - kHalf * fine) / kHalf;
    // Fine rungs are next to the present floor.
    const bool is_fine_below = before_mm != kNoJogFloor;
    std::array<double, kJogRungs> rungs;
    double at = margin_mm;
    for (std::uint32_t i = 0; i < kJogRungs; ++i) {
        rungs[i] = std::max(at, low);
        at -= (i < kHalf) == is_fine_below ? coarse : fine;
    }
    return rungs;
}

AxisLimits jog_limits(const JogRules& rules, const Axis& axis) noexcept {
    const bool is_rotary = axis.kind == AxisKind::rotary;
    return {.speed_max = std::min(axis.speed_max, is_rotary ? rules.speed_rad_s : rules.speed_mm_s),
            .acceleration_max =
                std::min(axis.acceleration_max,
                         is_rotary ? rules.acceleration_rad_s2 : rules.acceleration_mm_s2),
            .jerk_max = axis.jerk_max,
            .stopping_min = axis.stopping_min};
}

namespace {

/// Assumes no measured speed: the axis may be at its largest speed and still accelerate. A stop
/// from there first reduces the acceleration at the jerk limit, and the speed rises meanwhile.
AxisLimits limits_in_stop(const AxisLimits& limits) noexcept {
    AxisLimits in_stop = limits;
    in_stop.speed_max += 0.5 * limits.acceleration_max * limits.acceleration_max / limits.jerk_max;
    return in_stop;
}

}  // namespace

double jog_reach(const AxisLimits& limits, double free_s) noexcept {
    return forward_reach(limits_in_stop(limits), 0, limits.speed_max, free_s,
                         limits.acceleration_max);
}

double jog_turn_reach(const AxisLimits& limits) noexcept {
    AxisLimits in_stop = limits_in_stop(limits);
    in_stop.stop_turns_round = true;
    return forward_reach(in_stop, 0, 0, 0, limits.acceleration_max);
}

Reach reach_in_jog(const Machine& machine, const SampledMotion& motion, const JogMove& move,
                   std::uint32_t samples) noexcept {
    Reach reach{.kind = ReachKind::jog, .is_known = true};
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const double at = motion.snapshot().position[i], error = motion.held_error(i);
        ReachRange range{at - error, at + error};
        if (i == move.axis) {
            const AxisLimits limits = jog_limits(machine.guard.jog, machine.axes[i]);
            const double far = jog_reach(limits, free_seconds(machine, samples));
            const bool turns_round = machine.guard.stop_reversal == StopReversal::jerk_limited;
            const double back = turns_round ? jog_turn_reach(limits) : 0;
            range.low -= move.is_negative ? far : back;
            range.high += move.is_negative ? back : far;
        }
        put_reach(range, i, reach.box);
    }
    return reach;
}

namespace {

/// Signed travel from one position to another; the shorter direction for an unlimited axis.
double way_between(const Axis& axis, double from, double to) noexcept {
    return axis.unlimited ? std::remainder(to - from, 2 * kPi) : to - from;
}

}  // namespace

bool JogWatch::keeps_to(const Machine& machine, const AxisSnapshot& snapshot,
                        const std::array<SampleErrors, kAxesMax>& errors) noexcept {
    bool keeps = snapshot.tool == tool_;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double unknown = 2 * errors[i].position;  // of two reported positions
        if (i != move_.axis) {
            const double off = way_between(axis, from_[i], snapshot.position[i]);
            keeps = keeps && std::fabs(off) <= unknown;
            continue;
        }
        const double step =
            (move_.is_negative ? -1 : 1) * way_between(axis, at_[i], snapshot.position[i]);
        const double seconds =
            static_cast<double>(snapshot.sample - last_) * errors[i].period_s * (1 + kPeriodShare) +
            errors[i].latch_jitter_s;
        const double most = jog_limits(machine.guard.jog, axis).speed_max * seconds + unknown;
        way_ += step;
        keeps = keeps && step <= most && way_ >= farthest_ - unknown;
        farthest_ = std::max(farthest_, way_);
    }
    return keeps;
}

void JogWatch::begin(const AxisSnapshot& snapshot) noexcept {
    from_ = snapshot.position;
    tool_ = snapshot.tool;
    way_ = farthest_ = 0;
}

bool JogWatch::note(const Machine& machine, const AxisSnapshot& snapshot,
                    const std::array<SampleErrors, kAxesMax>& errors, bool is_first) noexcept {
    const JogMove said = machine.guard.jog.is_promised ? jog_of(snapshot) : JogMove{};
    if (said.axis == kNoIndex) {
        has_left_ = false;
    } else if (is_first || said != move_) {
        begin(snapshot);
        has_left_ = said.axis >= machine.axes.size();
        for (std::uint32_t i = 0; i < machine.axes.size() && !is_first; ++i) {
            const double off = way_between(machine.axes[i], at_[i], snapshot.position[i]);
            has_left_ = has_left_ || std::fabs(off) > 2 * errors[i].position;
        }
    } else {
        has_left_ = !keeps_to(machine, snapshot, errors) || has_left_;
    }
    move_ = said;
    at_ = snapshot.position;
    last_ = snapshot.sample;
    return !has_left_;
}

}  // namespace axg
