// SPDX-License-Identifier: Apache-2.0
// Whether a coherent snapshot can be true: travel, speed, standstill. The last line of defence
// behind checksums, which random bytes sometimes pass.
#pragma once

#include <array>
#include <cstdint>

#include "core/machine/axis_snapshot.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/receiver_faults.hpp"

namespace axg {

struct SnapshotFault {
    ReceiverFault fault = ReceiverFault::none;
    std::uint32_t axis = kNoIndex;
};

/// Compares each snapshot with the last one. Limits are those of the machine file: the same numbers
/// that the geometry was pruned with.
class SnapshotCheck {
  public:
    /// @param takes_jumps  no step is too long
    SnapshotCheck(const Machine& machine, const AxisFrameSet& set, bool takes_jumps) noexcept;

    /// Judges `snapshot`, `steps` sample periods after the last one. Positions up to half a count
    /// beyond the travel are the rounding of the wire and are set to the limit; farther out, a
    /// position within position_error is left unchanged.
    /// @param raw  counts on the wire; standstill is bit-equality of these
    [[nodiscard]] SnapshotFault check(AxisSnapshot& snapshot,
                                      const std::array<std::int64_t, kAxesMax>& raw,
                                      std::uint32_t steps) noexcept;
    /// Discards the last snapshot.
    void reset() noexcept { is_known_ = false; }

  private:
    struct AxisLimits {
        double min, max, speed_max, acceleration_max, unit, position_error;
        bool unlimited;
    };
    [[nodiscard]] SnapshotFault check_motion(const AxisSnapshot& snapshot,
                                             double elapsed_s) noexcept;

    std::array<AxisLimits, kAxesMax> limits_{};
    std::uint32_t axis_count_ = 0;
    double period_s_ = 0;
    double latch_jitter_s_ = 0;  // two samples may be that much farther apart in time
    std::uint64_t frozen_max_ = 1;
    std::uint64_t frozen_ = 0;  // sample periods of standstill under mode moving
    bool takes_jumps_ = false;
    bool is_known_ = false;  // there is a last snapshot
    std::array<double, kAxesMax> last_position_{};
    std::array<std::int64_t, kAxesMax> last_raw_{};
};

}  // namespace axg
