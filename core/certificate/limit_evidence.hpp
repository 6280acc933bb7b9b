// SPDX-License-Identifier: Apache-2.0
// Evidence that an axis broke its declared speed, acceleration or jerk: from differences of
// positions that errors and jitter cannot explain. Excess is a fact, so a healthy axis never shows
// any. A stop of the board's own may be harder than free motion, if rest follows. Pure, fixed size;
// mm and s, or rad and s. Source: docs/theory/certificate.md, "Broken limits".
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "core/certificate/limit_fact.hpp"
#include "core/certificate/machine_stop.hpp"
#include "core/certificate/motion_history.hpp"
#include "core/certificate/stop_reach.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// How often the error of one position counts in a difference: 1+1, 1+2+1, 1+3+3+1.
struct DifferenceWeights {
    double speed = 2, acceleration = 4, jerk = 8;
};

struct AxisLimitRules {
    AxisLimits limits;
    SampleErrors errors;
    bool unlimited = false;
    std::uint64_t stop_strides = 0;  // a stop of the board's own lasts at most so long; 0: none may
                                     // be harder than free motion
    std::uint64_t ramp_strides = 0;  // and its speed may rise for so long
    // No stop is harder, unless that of all axes is; infinite: not known.
    double stopping_most = std::numeric_limits<double>::infinity();
};

/// The declared limits of a machine, and how well its samples are known.
struct LimitRules {
    std::uint32_t axis_count = 0;
    std::uint32_t stride = 1;  // samples; points that are compared are multiples of it apart
    DifferenceWeights weights;
    bool stops_keep_path = false;  // axes may speed up, or turn round, within such a stop
    MachineStopRules machine_stop;
    std::array<AxisLimitRules, kAxesMax> axes{};
};

/// @param count  [axes] mm or rad of one count on the wire
[[nodiscard]] LimitRules limit_rules(const Machine& machine,
                                     std::span<const double> count) noexcept;

// Differences are taken over 1, 2, 4 and 8 strides; three of the longest are needed.
inline constexpr std::array<std::uint32_t, 4> kLimitStrides{1, 2, 4, 8};
inline constexpr std::uint32_t kLimitPoints = 32;  // positions kept, one a stride
static_assert(3 * kLimitStrides.back() < kLimitPoints);

/// A stop of the board's own, seen by an excess that only such a stop explains.
struct OwnStop {
    bool is_on = false;
    std::uint64_t begin = 0;       // stride of the first excess
    std::uint64_t falls_from = 0;  // from this stride on the speed only falls
    LimitFact cause;               // what was broken if rest does not follow
    std::array<double, kLimitStrides.size()> step_max{};  // later steps are not longer
    // What the axis was doing before any of it was seen: free motion from there leads at least as
    // far as any stop.
    std::uint64_t start = 0;  // stride
    AxisRange before;
    double moved = 0, last = 0;  // since then; the newest position
};

/// Since when the count of an axis has not changed, and its least speed then.
struct RestingCount {
    std::uint64_t since = 0;  // stride
    double position = 0, speed = 0;
};

struct LimitWatch {
    std::uint64_t newest = 0;                          // stride, a sample's number / stride
    std::array<std::uint64_t, kLimitPoints> stride{};  // that a point is of, and 1; 0: none
    std::array<std::array<double, kAxesMax>, kLimitPoints> position{};
    std::array<OwnStop, kAxesMax> stops{};
    MachineStop machine_stop;  // of all axes
    std::array<RestingCount, kAxesMax> resting{};
    std::array<std::uint64_t, kAxesMax> judged_from{};  // stride at which the last stop was over
    std::array<RangeFinding, kAxesMax> ranges{};        // at the newest snapshot
    std::array<std::array<AxisRange, kAxesMax>, kLimitPoints> believed{};  // at each point
};
static_assert(std::is_trivially_copyable_v<LimitWatch>);

/// Nothing before the next snapshot counts: the receiver began anew.
void forget_limits(LimitWatch& watch) noexcept;

/// One coherent snapshot. Returns the first fact found; it repeats as long as the window shows it.
/// @param history  the motion history, this snapshot noted
[[nodiscard]] LimitFact note_limits(LimitWatch& watch, const LimitRules& rules,
                                    const AxisSnapshot& snapshot,
                                    const MotionHistory& history) noexcept;

/// Whether bounds from `history` hold for this axis: no stop of the board's own is in it. Where
/// they do not, only the whole range of speed and acceleration is known.
[[nodiscard]] bool ranges_hold(const LimitWatch& watch, const LimitRules& rules,
                               const MotionHistory& history, std::uint32_t axis) noexcept;

/// Above this speed an axis whose count freezes is found; below it, it may have stopped within its
/// acceleration. Infinite: never (an endless axis that may turn half round in two strides).
[[nodiscard]] double blind_speed(const LimitRules& rules, std::uint32_t axis) noexcept;

/// The least speed, acceleration and jerk that explain the newest points of an axis; 0 where the
/// errors explain them alone.
struct LimitFigures {
    double speed = 0, acceleration = 0, jerk = 0;
    // As seen over the longest stride, errors not taken off: what the axis did, or a little more.
    double seen_speed = 0, seen_acceleration = 0;
};
[[nodiscard]] LimitFigures measure_limits(const LimitWatch& watch, const LimitRules& rules,
                                          std::uint32_t axis) noexcept;

}  // namespace axg
