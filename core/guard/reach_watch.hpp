// SPDX-License-Identifier: Apache-2.0
// Compares every stop in service with the reaches of the last permits: a stop that begins later or
// is softer than the machine file promises leaves all of them. Pure, from cycle to cycle; mm or
// rad.
// Claim: while a machine keeps its promises, each position from a permit's sample to standstill is
// in the reach that the permit was proven with. Proof: docs/theory/certificate.md, "How far an axis
// can go". Tests: reach_watch_test, long_stop_test.
#pragma once

#include <array>
#include <cstdint>

#include "core/certificate/stop_certificate.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

class ReachWatch {
  public:
    /// `machine` must outlive it.
    explicit ReachWatch(const Machine& machine) noexcept;

    /// For a recorded machine, which moves on whatever a present guard permits.
    void ignore() noexcept { is_ignored_ = true; }

    /// Compares a snapshot with the reach. Ends with the first standstill, with a new start of the
    /// receiver, and when twice the longest stop is over.
    /// @param error  [axes] largest error of a position
    void note(const AxisSnapshot& snapshot, bool is_first,
              const std::array<double, kAxesMax>& error) noexcept;

    /// Call after the verdict on the proof: stores the reach of a permit, or withholds it and names
    /// the axis that left the reach.
    /// @param reach  of all axes, that the permit was proven with
    void judge(const JointBox& reach, bool is_armed, CycleResult& result) noexcept;

  private:
    [[nodiscard]] LimitFact farthest(const JointBox& reach, const AxisSnapshot& snapshot,
                                     const std::array<double, kAxesMax>& error) const noexcept;

    // A board may obey any permit that has not ended: none is valid for more samples.
    static constexpr std::uint64_t kPermits = 16;

    const Machine* machine_;
    std::uint64_t aged_samples_;     // until a sample has no position from before the permit's
    std::uint64_t longest_samples_;  // twice the longest stop
    bool is_ignored_ = false;
    std::array<JointBox, kPermits> reach_{};
    std::uint64_t count_ = 0;             // of reaches since the watch began
    std::uint64_t sample_ = 0;            // newest
    std::uint64_t first_ = 0, last_ = 0;  // samples to compare
    LimitFact broken_;                    // farthest so far, until the watch ends
};

}  // namespace axg
