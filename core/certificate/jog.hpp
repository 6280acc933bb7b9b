// SPDX-License-Identifier: Apache-2.0
// Jogging out of a place near an obstacle: what the board says of a jog, how far its axis can get,
// how near a pair may come in it, and whether the axes keep to it. mm, rad and s. Pure.
// Source: docs/theory/certificate.md, "Jogging out".
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/certificate/motion_history.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// What a pair may lose of the clearance it has, beyond what errors of position may feign: for a
/// way that leads past an obstacle at first, before it leads away from it.
inline constexpr double kJogGiveMm = 0.02;

/// The distance that a pair keeps in a jog: its margin, or where it is nearer, what it has. At
/// least 0, and more than that everywhere: never a contact.
/// @param clearance_mm  certified, at the reported position
/// @param errors_mm     what the errors of a reported position can make of a distance; they count
///     three times: in this clearance, in that of a later position, and for the axes between
[[nodiscard]] constexpr double jog_floor_mm(double margin_mm, double clearance_mm,
                                            double errors_mm) noexcept {
    return std::max(0.0, std::min(margin_mm, clearance_mm - 3 * errors_mm - kJogGiveMm));
}

/// A pair's floor in a jog is the highest of these rungs that one query proves: a fixed number of
/// queries in place of a clearance. Rungs next to the floor in force are at most kJogRungMm apart.
inline constexpr std::uint32_t kJogRungs = 16;
inline constexpr double kJogRungMm = 0.05;
inline constexpr double kNoJogFloor = -1;  // mm; no jog before this one counts
/// Pairs nearer than their margin: more of them have no floor. Where a jog begins no more is asked
/// than by the last stage of a plan.
[[nodiscard]] constexpr std::uint32_t jog_ladders(const CyclePlan& plan) noexcept {
    return std::clamp(plan.queries[plan.stages - 1] / (kJogRungs - 1), 1U, 32U);
}

/// Floors from the margin down, mm; below the last rung comes `before_mm`, or 0 without one.
/// @param before_mm  the floor in force: what the jog before kept, which this one does not go
///     below; kNoJogFloor: the margin was
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

/// As the board reports it: the axis may be one that the machine does not have.
[[nodiscard]] JogMove jog_of(const AxisSnapshot& snapshot) noexcept;
/// Says it. Precondition: move.axis is one of the machine's.
void put_jog(const JogMove& move, AxisSnapshot& snapshot) noexcept;

/// The axis' limits in a jog; those of the stop are as ever.
[[nodiscard]] AxisLimits jog_limits(const JogRules& rules, const Axis& axis) noexcept;

/// How far its command can take the axis from any instant of a jog to standstill, in the jog's
/// direction; the other way it does not go.
/// @param free_s  until braking must have begun
[[nodiscard]] double jog_reach(const AxisLimits& limits, double free_s) noexcept;

/// How far back it goes in a stop that turns it round (StopReversal::jerk_limited).
[[nodiscard]] double jog_turn_reach(const AxisLimits& limits) noexcept;

/// Whether the axes keep to the jog that the board reports: all stand where it begins, then one
/// alone moves, never back and never too fast, as far as errors of position let that be told.
class JogWatch {
  public:
    /// The newest snapshot.
    /// @param errors    [axes] of a reported position
    /// @param is_first  nothing before it counts
    /// @return false: it does not keep to it, or it is a jog of no axis. Stays so until the jog
    /// ends
    [[nodiscard]] bool note(const Machine& machine, const AxisSnapshot& snapshot,
                            const std::array<SampleErrors, kAxesMax>& errors,
                            bool is_first) noexcept;

    /// No axis: the newest snapshot is of no jog that the machine file makes a promise about.
    [[nodiscard]] const JogMove& move() const noexcept { return move_; }
    [[nodiscard]] bool is_on() const noexcept { return move_.axis != kNoIndex; }

  private:
    void begin(const AxisSnapshot& snapshot) noexcept;
    [[nodiscard]] bool keeps_to(const Machine& machine, const AxisSnapshot& snapshot,
                                const std::array<SampleErrors, kAxesMax>& errors) noexcept;

    JogMove move_;
    std::array<double, kAxesMax> from_{}, at_{};  // where it began, and of the newest snapshot
    std::uint64_t last_ = 0;                      // sample
    double way_ = 0, farthest_ = 0;               // of the axis since it began
    std::uint16_t tool_ = 0;
    bool has_left_ = false;
};

}  // namespace axg
