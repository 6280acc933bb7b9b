// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/receiver/snapshot_check.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"
#include "core/base/sincos.hpp"
#include "core/reach/stop_limits.hpp"

namespace axg {
namespace {

/// The shorter way round for an endless axis.
double step_between(double from, double to, bool unlimited) noexcept {
    const double step = to - from;
    return unlimited ? step - 2 * kPi * std::round(step / (2 * kPi)) : step;
}

}  // namespace

SnapshotCheck::SnapshotCheck(const Machine& machine, const AxisFrameSet& set,
                             bool takes_jumps) noexcept
    : axis_count_(set.axis_count),
      period_s_(set.sample_us * 1.0e-6),
      // Frames without an instant may be so late, as sample_errors() supposes.
      latch_jitter_s_(
          std::max(machine.guard.latch_jitter_s, arrival_jitter_us_of(machine.can) * 1e-6) +
          age_seconds(machine).spread),
      frozen_max_(std::max<std::uint32_t>(1, machine.can.frozen_samples)),
      takes_jumps_(takes_jumps) {
    for (std::uint32_t i = 0; i < axis_count_; ++i) {
        const Axis& axis = machine.axes[i];
        limits_[i] = {axis.min,
                      axis.max,
                      axis.speed_max,
                      axis.acceleration_max,
                      set.axes[i].unit,
                      axis.position_error,
                      set.axes[i].unlimited};
    }
}

SnapshotFault SnapshotCheck::check(AxisSnapshot& snapshot,
                                   const std::array<std::int64_t, kAxesMax>& raw,
                                   std::uint32_t steps) noexcept {
    for (std::uint32_t i = 0; i < axis_count_; ++i) {
        const AxisLimits& limits = limits_[i];
        double& position = snapshot.position[i];
        if (!is_finite(position)) {
            return {ReceiverFault::no_position, i};
        }
        if (limits.unlimited) {
            continue;
        }
        const double rounding = 0.5 * limits.unit * (1 + 1.0e-6);
        const double beyond = std::max(limits.min - position, position - limits.max);
        if (beyond > rounding + limits.position_error) {
            return {ReceiverFault::out_of_travel, i};
        }
        if (beyond <= rounding) {
            position = std::clamp(position, limits.min, limits.max);
        }
    }
    if ((snapshot.flags & kFlagNotHomed) != 0) {
        return {ReceiverFault::not_homed};
    }
    if (is_known_) {
        const double elapsed_s = steps * period_s_;
        const SnapshotFault fault = check_motion(snapshot, elapsed_s);
        if (fault.fault != ReceiverFault::none) {
            return fault;
        }
        const bool is_still = std::equal(raw.begin(), raw.begin() + axis_count_, last_raw_.begin());
        frozen_ = is_still && snapshot.mode == kModeMoving ? frozen_ + steps : 0;
        if (frozen_ >= frozen_max_) {
            return {ReceiverFault::frozen};
        }
    } else {
        frozen_ = 0;
    }
    is_known_ = true;
    last_position_ = snapshot.position;
    last_raw_ = raw;
    return {};
}

SnapshotFault SnapshotCheck::check_motion(const AxisSnapshot& snapshot, double elapsed_s) noexcept {
    for (std::uint32_t i = 0; i < axis_count_; ++i) {
        const AxisLimits& limits = limits_[i];
        const double step = step_between(last_position_[i], snapshot.position[i], limits.unlimited);
        // Two roundings of half a count each, two errors of the encoder, and what the speed may
        // gain while the sample lasts.
        const double reach = limits.speed_max * (elapsed_s + latch_jitter_s_) +
                             limits.acceleration_max * elapsed_s * elapsed_s + limits.unit +
                             2 * limits.position_error;
        if (!takes_jumps_ && !(std::abs(step) <= reach * (1 + 1.0e-9))) {
            return {ReceiverFault::jump, i};
        }
    }
    return {};
}

}  // namespace axg
