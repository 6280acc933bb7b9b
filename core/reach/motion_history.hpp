// SPDX-License-Identifier: Apache-2.0
// Bounds the speed and acceleration of each axis from the positions of the last samples: frames
// carry no speed. Pure, no allocation; mm and s, or rad and s.
// Source: docs/theory/certificate.md, "Speed from positions".
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {

/// Largest relative error of the board's period `sample_us` (docs/reference/protocol.md, rule 6).
inline constexpr double kPeriodShare = 0.01;

inline constexpr std::uint32_t kSamplesKept = 17;  // the newest and 16 older ones

/// The last snapshots, newest first, at least a stride of samples apart except the newest.
struct MotionHistory {
    std::uint32_t count = 0;
    std::array<std::uint64_t, kSamplesKept> sample{};
    std::array<std::array<double, kAxesMax>, kSamplesKept> position{};
};
static_assert(std::is_trivially_copyable_v<MotionHistory>);

/// Adds a snapshot. Clears the history first if the snapshot is not newer than the newest.
/// @param stride  samples between stored snapshots, at least 1 (history_stride)
void note_snapshot(MotionHistory& history, const AxisSnapshot& snapshot,
                   std::uint32_t stride) noexcept;

/// Error bounds of the instants and positions of samples.
struct SampleErrors {
    double period_s = 0;           // nominal
    double period_share = 0;       // largest relative error of the period, equal for all samples
    double latch_jitter_s = 0;     // largest error of the time between two samples' positions
    double position = 0;           // of a reported position against the true one at its latch
    bool is_jerk_limited = false;  // jerk_max also limits free motion
};

/// Samples in one stride: 1 ms rounded to whole periods, at least one. Closer samples yield loose
/// bounds of the acceleration.
[[nodiscard]] std::uint32_t history_stride(double period_s) noexcept;

/// The range of an axis, and whether the snapshots contradict the promised limits.
struct RangeFinding {
    AxisRange range;  // the limits themselves if the snapshots contradict them
    // Excess of the lower bound of speed (acceleration) over the upper one; 0: no contradiction.
    double speed_gap = 0, acceleration_gap = 0;
};

/// @param is_unlimited  an endless axis: a difference of positions is at most half a turn
/// Precondition: a snapshot was noted.
[[nodiscard]] RangeFinding find_range(const MotionHistory& history, std::uint32_t axis,
                                      const AxisLimits& limits, bool is_unlimited,
                                      const SampleErrors& errors) noexcept;

/// Bounds of position, speed and acceleration at the instant of the newest snapshot. Returns the
/// whole range of speed and acceleration if the snapshots do not bound them, or contradict the
/// promised limits. Precondition: a snapshot was noted.
[[nodiscard]] AxisRange range_of(const MotionHistory& history, std::uint32_t axis,
                                 const Axis& promised, const SampleErrors& errors) noexcept;

}  // namespace axg
