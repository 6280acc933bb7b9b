// SPDX-License-Identifier: Apache-2.0
// The motion of the axes as their samples show it: ranges of position, speed and acceleration at
// the newest sample, and a broken limit or a stop of the board's own.
// Claim: the true motion is within the ranges, or a limit is broken. Proof:
// docs/theory/certificate.md, "Speed from positions" and "Broken limits". Tests:
// motion_history_test, limit_evidence_test, left_limits_test.
#pragma once

#include <array>
#include <cstdint>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/limit_evidence.hpp"
#include "core/reach/motion_history.hpp"
#include "core/reach/stop_limits.hpp"

namespace axg {

class SampledMotion {
  public:
    /// `machine` must outlive it.
    /// @param count  [axes] mm or rad of one count on the wire
    SampledMotion(const Machine& machine, const std::array<double, kAxesMax>& count) noexcept;

    /// @param is_first  the receiver has restarted: discards earlier snapshots
    void note(const AxisSnapshot& snapshot, bool is_first) noexcept;
    /// A cycle has used status and fact: from now on the newest snapshot alone decides them.
    void keep() noexcept { is_judged_ = true; }

    [[nodiscard]] const AxisSnapshot& snapshot() const noexcept { return snapshot_; }
    /// One snapshot gives no speed.
    [[nodiscard]] bool has_speed() const noexcept { return history_.count > 1; }
    /// The history is full: speeds and accelerations have their tightest bounds.
    [[nodiscard]] bool is_settled() const noexcept { return history_.count == kSamplesKept; }
    /// Range of `axis` at the newest snapshot; its whole range of speed and acceleration in a stop
    /// of the board's own, until 16 strides of rest are over. Precondition: a snapshot was noted.
    [[nodiscard]] AxisRange now(std::uint32_t axis) const noexcept;
    [[nodiscard]] SampleErrors errors_of(std::uint32_t axis) const noexcept {
        return sample_errors(*machine_, axis, count_[axis]);
    }
    /// Largest distance of `axis` from its position in the newest snapshot while it has no command
    /// to move, mm or rad: the snapshot may differ from the command, and so may later positions.
    [[nodiscard]] double held_error(std::uint32_t axis) const noexcept {
        return errors_of(axis).position + machine_->axes[axis].following_error;
    }
    /// ok, left_limits or own_stop.
    [[nodiscard]] SnapshotStatus status() const noexcept;
    /// The cause of own_stop, else the broken limit.
    [[nodiscard]] const LimitFact& fact(SnapshotStatus status) const noexcept {
        return status == SnapshotStatus::own_stop ? own_stop_ : broken_limit_;
    }

  private:
    const Machine* machine_;
    std::array<double, kAxesMax> count_;
    LimitRules rules_;
    std::uint32_t stride_;
    AxisSnapshot snapshot_;
    MotionHistory history_;
    LimitWatch watch_;
    LimitFact broken_limit_;  // held until a cycle has used it and the window shows none
    LimitFact own_stop_;      // likewise, for a stop of the board's own
    bool is_judged_ = true;   // a cycle has used them
};

}  // namespace axg
