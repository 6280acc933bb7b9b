// SPDX-License-Identifier: Apache-2.0
// Jogging away from an obstacle: the jog that the board reports, the reach of its axis, the rungs
// of a floor, and whether the axes follow it. mm, rad and s. Pure.
// Claim: in a jog every position to standstill is in its reach, or JogWatch reports otherwise.
// Proof: docs/theory/certificate.md, "Jogging out". Tests: unit and oracle jog_test.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/motion_history.hpp"
#include "core/reach/reach.hpp"
#include "core/reach/sampled_motion.hpp"

namespace axg {

/// Clearance that a pair may lose in a jog, in addition to apparent changes by position errors:
/// allows a jog that first passes an obstacle before it leads away from it.
inline constexpr double kJogGiveMm = 0.02;

/// Jog floor: the pair's margin or, if the pair is nearer, its clearance less the errors. At least
/// 0. A proof requires more distance than the floor, so a contact is never permitted.
/// @param clearance_mm  certified, at the reported position
/// @param errors_mm     largest change of a distance by the errors of a reported position; they
///     count three times: in this clearance, in that of a later position, and for the axes between
[[nodiscard]] constexpr double jog_floor_mm(double margin_mm, double clearance_mm,
                                            double errors_mm) noexcept {
    return std::max(0.0, std::min(margin_mm, clearance_mm - 3 * errors_mm - kJogGiveMm));
}

/// A pair's floor in a jog is the highest of these rungs that one query proves. This needs a fixed
/// number of queries and no clearance. Rungs near the present floor are at most kJogRungMm apart.
inline constexpr std::uint32_t kJogRungs = 16;
inline constexpr double kJogRungMm = 0.05;
inline constexpr double kNoJogFloor = -1;  // mm; no earlier jog counts
/// Largest number of pairs nearer than their margin for which a jog has floors. The start of a jog
/// runs no more queries than the last stage of a plan.
[[nodiscard]] constexpr std::uint32_t jog_ladders(const CyclePlan& plan) noexcept {
    return std::clamp(plan.queries[plan.stages - 1] / (kJogRungs - 1), 1U, 32U);
}

/// Floors from the margin down, mm; no rung is below `before_mm`, or below 0 without one.
/// @param before_mm  floor of the jog before, the lower bound of this one; kNoJogFloor: the margin
///     was the floor
[[nodiscard]] std::array<double, kJogRungs> jog_ladder(double margin_mm, double before_mm) noexcept;

/// The distance that proves a rung.
[[nodiscard]] constexpr double jog_rung_query_mm(double floor_mm, double errors_mm) noexcept {
    return floor_mm + 3 * errors_mm + kJogGiveMm;
}

/// One axis, one way.
struct JogMove {
    std::uint32_t axis = kNoIndex;  // Machine::axes; kNoIndex: no jog
    bool is_negative = false;

    friend constexpr bool operator==(const JogMove&, const JogMove&) = default;
};

/// The jog that the board reports; its axis index may exceed the machine's axes.
[[nodiscard]] JogMove jog_of(const AxisSnapshot& snapshot) noexcept;
/// Writes it into the snapshot. Precondition: move.axis is an axis of the machine.
void put_jog(const JogMove& move, AxisSnapshot& snapshot) noexcept;

/// The axis' limits in a jog; jerk and stopping deceleration are unchanged.
[[nodiscard]] AxisLimits jog_limits(const JogRules& rules, const Axis& axis) noexcept;

/// How far the commanded position can move from any instant of a jog to standstill, in the jog's
/// direction; it does not move the other way.
/// @param free_s  latest start of braking
[[nodiscard]] double jog_reach(const AxisLimits& limits, double free_s) noexcept;

/// How far it moves back in a stop that reverses the axis (StopReversal::jerk_limited).
[[nodiscard]] double jog_turn_reach(const AxisLimits& limits) noexcept;

/// Reach of a jog: all axes at their present positions, and the jog's axis over its whole reach.
/// @param samples  n of the permit
[[nodiscard]] Reach reach_in_jog(const Machine& machine, const SampledMotion& motion,
                                 const JogMove& move, std::uint32_t samples) noexcept;

/// Checks that the axes follow the jog that the board reports, within the errors of position: all
/// axes are at rest when it begins, then only one moves, never back and never too fast.
class JogWatch {
  public:
    /// Checks the newest snapshot.
    /// @param errors    [axes] of a reported position
    /// @param is_first  earlier snapshots do not count
    /// @return false: the axes do not follow the jog, or the machine lacks its axis. Remains false
    /// until the jog ends
    [[nodiscard]] bool note(const Machine& machine, const AxisSnapshot& snapshot,
                            const std::array<SampleErrors, kAxesMax>& errors,
                            bool is_first) noexcept;

    /// No axis: the snapshot reports no jog, or the machine file does not promise single_jog.
    [[nodiscard]] const JogMove& move() const noexcept { return move_; }
    [[nodiscard]] bool is_on() const noexcept { return move_.axis != kNoIndex; }

  private:
    void begin(const AxisSnapshot& snapshot) noexcept;
    [[nodiscard]] bool keeps_to(const Machine& machine, const AxisSnapshot& snapshot,
                                const std::array<SampleErrors, kAxesMax>& errors) noexcept;

    JogMove move_;
    std::array<double, kAxesMax> from_{}, at_{};  // positions at its start, and the newest
    std::uint64_t last_ = 0;                      // sample
    double way_ = 0, farthest_ = 0;               // of the axis since the start
    std::uint16_t tool_ = 0;
    bool has_left_ = false;
};

}  // namespace axg
