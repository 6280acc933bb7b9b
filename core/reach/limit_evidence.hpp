// SPDX-License-Identifier: Apache-2.0
// Detects that an axis broke its declared speed, acceleration or jerk: differences of positions
// exceed what errors and jitter can explain. A healthy axis never shows an excess. A stop of the
// board's own may be harder than free motion, if rest follows. Pure, fixed size; mm and s, or rad
// and s. Source: docs/theory/certificate.md, "Broken limits".
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/limit_fact.hpp"
#include "core/reach/machine_stop.hpp"
#include "core/reach/motion_history.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {

/// Multiples of one position's error in a difference: 1+1, 1+2+1, 1+3+3+1.
struct DifferenceWeights {
    double speed = 2, acceleration = 4, jerk = 8;
};

struct AxisLimitRules {
    AxisLimits limits;
    SampleErrors errors;
    bool unlimited = false;
    std::uint64_t stop_strides = 0;  // longest stop of the board's own; 0: no stop may be harder
                                     // than free motion
    std::uint64_t ramp_strides = 0;  // longest rise of the speed during such a stop
    // Above this deceleration a stop counts only if all axes stop; infinite: limit unknown.
    double stopping_most = std::numeric_limits<double>::infinity();
};

/// The declared limits of a machine, and the error bounds of its samples.
struct LimitRules {
    std::uint32_t axis_count = 0;
    std::uint32_t stride = 1;  // samples; compared points are multiples of it apart
    DifferenceWeights weights;
    bool stops_keep_path = false;  // axes may speed up or reverse within such a stop
    MachineStopRules machine_stop;
    std::array<AxisLimitRules, kAxesMax> axes{};
};

/// @param count  [axes] mm or rad of one count on the wire
[[nodiscard]] LimitRules limit_rules(const Machine& machine,
                                     std::span<const double> count) noexcept;

// Differences span 1, 2, 4 and 8 strides; the points have to cover three of the longest.
inline constexpr std::array<std::uint32_t, 4> kLimitStrides{1, 2, 4, 8};
inline constexpr std::uint32_t kLimitPoints = 32;  // stored positions, one per stride
static_assert(3 * kLimitStrides.back() < kLimitPoints);

/// A stop of the board's own, detected by an excess that only such a stop explains.
struct OwnStop {
    bool is_on = false;
    std::uint64_t begin = 0;       // stride of the first excess
    std::uint64_t falls_from = 0;  // from this stride on the speed may only fall
    LimitFact cause;               // the broken limit if rest does not follow
    std::array<double, kLimitStrides.size()> step_max{};  // later steps are not longer
    // The axis' range before the first sign of the stop: free motion from there leads at least as
    // far as any stop.
    std::uint64_t start = 0;  // stride
    AxisRange before;
    double moved = 0, last = 0;  // travel since `start`; the newest position
};

/// Stride since which the count of an axis has not changed, and its least speed then.
struct RestingCount {
    std::uint64_t since = 0;
    double position = 0, speed = 0;
};

struct LimitWatch {
    std::uint64_t newest = 0;                          // stride, a sample's number / stride
    std::array<std::uint64_t, kLimitPoints> stride{};  // stride of a point plus 1; 0: empty
    std::array<std::array<double, kAxesMax>, kLimitPoints> position{};
    std::array<OwnStop, kAxesMax> stops{};
    MachineStop machine_stop;  // of all axes
    std::array<RestingCount, kAxesMax> resting{};
    std::array<std::uint64_t, kAxesMax> judged_from{};  // first stride at rest of the last stop
    std::array<RangeFinding, kAxesMax> ranges{};        // at the newest snapshot
    std::array<std::array<AxisRange, kAxesMax>, kLimitPoints> believed{};  // at each point
};
static_assert(std::is_trivially_copyable_v<LimitWatch>);

/// Discards all snapshots so far, for a receiver that restarts.
void forget_limits(LimitWatch& watch) noexcept;

/// Adds a coherent snapshot. Returns the first fact found, again as long as the window shows it.
/// @param history  the motion history, which already contains this snapshot
[[nodiscard]] LimitFact note_limits(LimitWatch& watch, const LimitRules& rules,
                                    const AxisSnapshot& snapshot,
                                    const MotionHistory& history) noexcept;

/// Whether bounds from `history` hold for this axis: it contains no stop of the board's own. If
/// they do not hold, use the whole range of speed and acceleration.
[[nodiscard]] bool ranges_hold(const LimitWatch& watch, const LimitRules& rules,
                               const MotionHistory& history, std::uint32_t axis) noexcept;

/// Above this speed a frozen count is detected; below it, the axis may have stopped within its
/// acceleration. Infinite: never detected (an endless axis that may turn by half in two strides).
[[nodiscard]] double blind_speed(const LimitRules& rules, std::uint32_t axis) noexcept;

/// The least speed, acceleration and jerk that explain the newest points of an axis; 0 if errors
/// alone explain them.
struct LimitFigures {
    double speed = 0, acceleration = 0, jerk = 0;
    // Measured over the longest stride, errors not subtracted: the true value or a little more.
    double seen_speed = 0, seen_acceleration = 0;
};
[[nodiscard]] LimitFigures measure_limits(const LimitWatch& watch, const LimitRules& rules,
                                          std::uint32_t axis) noexcept;

}  // namespace axg
