// SPDX-License-Identifier: Apache-2.0
#include "core/reach/sampled_motion.hpp"

namespace axg {

SampledMotion::SampledMotion(const Machine& machine,
                             const std::array<double, kAxesMax>& count) noexcept
    : machine_(&machine),
      count_(count),
      rules_(limit_rules(machine, count_)),
      stride_(history_stride(machine.can.sample_us * 1e-6)) {}

void SampledMotion::note(const AxisSnapshot& snapshot, bool is_first) noexcept {
    snapshot_ = snapshot;
    history_.count = is_first ? 0 : history_.count;
    note_snapshot(history_, snapshot, stride_);
    if (is_first) {
        forget_limits(watch_);
        broken_limit_ = own_stop_ = {};
    }
    const LimitFact fact = note_limits(watch_, rules_, snapshot_, history_);
    if (watch_.machine_stop.is_on) {
        own_stop_ = watch_.machine_stop.cause;
        is_judged_ = false;
    }
    if (fact.kind != LimitKind::none) {
        broken_limit_ = fact;
        is_judged_ = false;
    } else if (is_judged_ && snapshot_.sample % rules_.stride == 0) {
        broken_limit_ = own_stop_ = {};
    }
}

AxisRange SampledMotion::now(std::uint32_t axis) const noexcept {
    const Axis& promised = machine_->axes[axis];
    AxisRange range = watch_.ranges[axis].range;
    if (!ranges_hold(watch_, rules_, history_, axis)) {
        range.speed_low = -promised.speed_max;
        range.speed_high = promised.speed_max;
        range.acceleration_low = -promised.acceleration_max;
        range.acceleration_high = promised.acceleration_max;
    }
    return range;
}

SnapshotStatus SampledMotion::status() const noexcept {
    if (machine_->guard.reports_limits) {
        return SnapshotStatus::ok;
    }
    return broken_limit_.kind != LimitKind::none ? SnapshotStatus::left_limits
           : own_stop_.kind != LimitKind::none   ? SnapshotStatus::own_stop
                                                 : SnapshotStatus::ok;
}

}  // namespace axg
