// SPDX-License-Identifier: Apache-2.0
// How a simulated board keeps a cap of its own for each axis: it tells its planner what each may
// have, knows from it what each will have, and names a permit when none is faster. Source:
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

/// How a board that says that it keeps the cap of the permits keeps it.
enum class CapFault : std::uint8_t {
    none = 0,
    late,     // acknowledges at once, and begins to slow down a tenth of a second later
    half,     // acknowledges at once, and goes twice as fast
    ignores,  // acknowledges at once, and goes on as before
};
inline constexpr std::int64_t kCapLateUs = 100'000;  // CapFault::late
inline constexpr double kCapShare = 0.98;            // of a cap, that it stays below
inline constexpr double kCapCounts = 1e-6;  // of 1/250 of rapid: an axis that is slower stands

/// What an axis has, and what a stop that begins now would bring it to, of its largest speed: it
/// takes the acceleration away with the jerk that is guaranteed at least.
[[nodiscard]] double share_in_stop(const Axis& axis, const AxisMotion& now) noexcept;

struct CapKeeping {
    double smooth_s = 0;  // the motion comes to what it is told within so much averaging
    CapFault fault = CapFault::none;
};

class AxisCapKeeper {
  public:
    /// `machine` and `shares` must outlive it.
    AxisCapKeeper(const Machine& machine, AxisShares& shares, const CapKeeping& keeping);

    /// The axes now. False: one is faster than what is kept.
    bool note(std::span<const AxisMotion> axes) noexcept;
    /// Once a period, between motion and latch.
    /// @param most  share of every axis' largest speed, whatever the caps are
    void keep(PermitWatch& watch, double most, std::int64_t now_us);
    [[nodiscard]] std::uint8_t least_kept() const noexcept;

  private:
    using Shares = std::array<double, kAxesMax>;
    [[nodiscard]] static Shares largest_of(const std::vector<Shares>& of) noexcept;
    [[nodiscard]] Shares obeyed(const Shares& wanted) noexcept;

    const Machine* machine_;
    AxisShares* shares_;
    CapKeeping keeping_;
    std::vector<Shares> needed_;  // that the planner said, so long as they may act
    std::vector<Shares> late_;
    std::size_t slot_ = 0;
    Shares fastest_{};  // since the last sample
    CapGroups kept_{};
};

}  // namespace axg
