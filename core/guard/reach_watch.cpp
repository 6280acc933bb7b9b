// SPDX-License-Identifier: Apache-2.0
#include "core/guard/reach_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/sincos.hpp"
#include "core/guard/cap_guard.hpp"
#include "core/reach/stop_limits.hpp"

namespace axg {
namespace {

constexpr std::uint64_t kUnbounded = UINT64_MAX / 4;  // an axis without a promised stop

/// Samples from that of a permit until all axes rest, at most.
std::uint64_t longest_stop(const Machine& machine) noexcept {
    double braking_s = 0;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const AxisLimits limits = stop_limits(machine, i);
        const double ramp_s =
            has_jerk_limit(machine.axes[i])
                ? (limits.acceleration_max + limits.stopping_min) / limits.jerk_max
                : 0;
        braking_s = std::max(braking_s, limits.speed_max / limits.stopping_min + ramp_s);
    }
    const double stop_s = free_seconds(machine, machine.can.permit_samples.most) + braking_s;
    const double samples = std::ceil(stop_s / (machine.can.sample_us * 1e-6));
    return std::isfinite(samples) ? static_cast<std::uint64_t>(samples) : kUnbounded;
}

/// How far a position is outside the box.
double beyond(const Axis& axis, double position, double centre, double half) noexcept {
    double off = position - centre;
    if (axis.unlimited) {
        off -= 2 * kPi * std::round(off / (2 * kPi));
    }
    return std::fabs(off) - half;
}

}  // namespace

ReachWatch::ReachWatch(const Machine& machine) noexcept
    : machine_(&machine),
      aged_samples_(age_samples(machine)),
      longest_samples_(2 * longest_stop(machine)) {}

/// The axis farthest outside of one reach; not positive: none.
LimitFact ReachWatch::farthest(const JointBox& reach, const AxisSnapshot& snapshot,
                               const std::array<double, kAxesMax>& error) const noexcept {
    LimitFact out{.kind = LimitKind::left_reach,
                  .measured = -std::numeric_limits<double>::infinity(),
                  .sample = snapshot.sample};
    for (std::uint32_t i = 0; i < machine_->axes.size(); ++i) {
        const double off = beyond(machine_->axes[i], snapshot.position[i], reach.centre[i],
                                  reach.half[i] + error[i]);
        if (off > out.measured) {
            out.measured = off;
            out.axis = i;
        }
    }
    return out;
}

void ReachWatch::note(const AxisSnapshot& snapshot, bool is_first,
                      const std::array<double, kAxesMax>& error) noexcept {
    sample_ = snapshot.sample;
    // A machine at rest begins to move under any permit that has not ended.
    const bool stands = snapshot.mode == kModeStandstill && sample_ >= first_ + kPermits;
    if (is_first || stands || sample_ > last_) {
        count_ = 0;
        broken_ = {};
    }
    if (count_ == 0 || sample_ < first_) {
        return;
    }
    LimitFact nearest{.measured = std::numeric_limits<double>::infinity()};
    for (std::uint64_t n = 0; n < std::min<std::uint64_t>(count_, kPermits); ++n) {
        const LimitFact one = farthest(reach_[n], snapshot, error);
        nearest = one.measured < nearest.measured ? one : nearest;
    }
    if (nearest.measured > broken_.measured) {
        broken_ = nearest;
    }
}

void ReachWatch::judge(const JointBox& reach, bool is_armed, CycleResult& result) noexcept {
    if (is_ignored_ || machine_->guard.reports_limits) {
        return;
    }
    if (broken_.kind == LimitKind::none) {
        if (result.has_permit && is_armed) {
            reach_[count_++ % kPermits] = reach;
            first_ = sample_ + aged_samples_;
            last_ = first_ + longest_samples_;
        }
        return;
    }
    if (result.reason == StopReason::left_limits || result.reason == StopReason::left_cap) {
        return;  // the cause is known
    }
    result.reason = StopReason::left_limits;
    result.limit = broken_;
    result.pair = kNoIndex;
    result.is_stop = result.is_stop || is_armed;
    result.has_permit = false;
}

}  // namespace axg
