// SPDX-License-Identifier: Apache-2.0
// Whether the axes are at rest, from the frames of the bus. It uses its own receiver and
// acknowledges its faults: the guard's receiver may be INVALID while the machine is at rest.
// No clock, no allocation. Source: docs/reference/states.md, "Standstill".
#pragma once

#include <cstdint>
#include <string>

#include "core/guard/standstill.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

/// With the counts of the frames of this machine.
[[nodiscard]] StandstillRules standstill_rules(const Machine& machine) noexcept;
/// Why no stop of this machine could ever be confirmed, and what to add to its file; empty: its
/// frames decide it.
[[nodiscard]] std::string standstill_refusal(const Machine& machine);

class StandstillWatch {
  public:
    /// @param after_us  samples latched up to this instant do not count
    StandstillWatch(const Machine& machine, ReceiverOptions options, const StandstillRules& rules,
                    std::int64_t after_us) noexcept;

    /// Begins at a stop: only samples latched after it count.
    void begin(std::int64_t after_us) noexcept;
    /// Every frame of the bus, in order of arrival.
    void on_frame(const CanFrame& frame) noexcept;
    [[nodiscard]] bool stands(std::int64_t now_us) const noexcept {
        return axg::stands(state_, rules_, now_us);
    }
    /// Any axis that moved in the window; kNoIndex: none, or there is no sample.
    [[nodiscard]] std::uint32_t moving_axis() const noexcept {
        return axg::moving_axis(state_, rules_);
    }
    /// The axis that moves while the frames report rest for twice the window; kNoIndex:
    /// none, or the frames never report rest.
    [[nodiscard]] std::uint32_t contradicted_axis() const noexcept;

  private:
    void note_path(const PathPoints& points) noexcept;
    [[nodiscard]] bool has_still_path(std::uint64_t sample) const noexcept;

    AxisReceiver receiver_;
    StandstillRules rules_;
    Standstill state_;
    std::uint64_t said_since_ = 0;  // sample from which on the mode has been standstill
    std::int64_t after_us_ = INT64_MIN;
    std::uint32_t look_ahead_samples_;  // 0: the board announces no path
    PathPoints path_;                   // the newest points
    bool has_path_ = false;
    bool is_path_still_ = false;  // they are equal, and equal to the points before
};

}  // namespace axg
