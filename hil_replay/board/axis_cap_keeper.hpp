// SPDX-License-Identifier: Apache-2.0
// Enforces a cap for each axis of a simulated board: sends the bounds to the planner, reads from it
// the speeds to come, and acknowledges a permit once no axis is faster. Source:
// docs/reference/board.md, "The cap".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/guard/ack_ledger.hpp"
#include "core/machine/machine.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/board/permit_watch.hpp"

namespace axg {

/// How a board breaks its promise to obey the caps of permits; none: it obeys.
enum class CapFault : std::uint8_t {
    none = 0,
    late,     // acknowledges at once, and begins to slow down a tenth of a second later
    half,     // acknowledges at once, and goes twice as fast
    ignores,  // acknowledges at once, and goes on as before
};
inline constexpr std::int64_t kCapLateUs = 100'000;  // CapFault::late
inline constexpr double kCapShare = 0.98;            // the board stays below this share of a cap
inline constexpr double kCapCounts = 1e-6;  // of 1/250 of rapid: a slower axis counts as at rest

/// Highest speed that an axis reaches in a stop from now, as a share of Axis::speed_max: the stop
/// removes the acceleration with the lowest guaranteed jerk.
[[nodiscard]] double share_in_stop(const Axis& axis, const AxisMotion& now) noexcept;

struct CapKeeping {
    double smooth_s = 0;  // averaging time within which the motion obeys a new share
    CapFault fault = CapFault::none;
};

class AxisCapKeeper {
  public:
    /// `machine` and `shares` must outlive it.
    AxisCapKeeper(const Machine& machine, AxisShares& shares, const CapKeeping& keeping);

    /// Records the speeds of the axes now. False: an axis exceeds the cap in force.
    bool note(std::span<const AxisMotion> axes) noexcept;
    /// Call once a period, between motion and latch.
    /// @param most  bound of every axis' share of its largest speed, whatever the caps are
    void keep(PermitWatch& watch, double most, std::int64_t now_us);
    [[nodiscard]] std::uint8_t least_kept() const noexcept;

  private:
    using Shares = std::array<double, kAxesMax>;
    [[nodiscard]] static Shares largest_of(const std::vector<Shares>& of) noexcept;
    [[nodiscard]] Shares obeyed(const Shares& wanted) noexcept;

    const Machine* machine_;
    AxisShares* shares_;
    CapKeeping keeping_;
    std::vector<Shares> needed_;  // from the planner, while they may act
    std::vector<Shares> late_;
    std::size_t slot_ = 0;
    Shares fastest_{};  // since the last sample
    CapGroups kept_{};
};

}  // namespace axg
