// SPDX-License-Identifier: Apache-2.0
// Speed and acceleration of each axis, bounded from the positions of the last samples: frames carry
// no speed. Pure, no allocation; mm and s, or rad and s. Source: docs/theory/certificate.md, "What
// positions say about speed".
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/certificate/stop_reach.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The period of the board is `sample_us` to this share (docs/reference/protocol.md, rule 6).
inline constexpr double kPeriodShare = 0.01;

inline constexpr std::uint32_t kSamplesKept = 17;  // the newest, and 16 behind it

/// The last snapshots, newest first, at least a stride of samples apart but for the newest.
struct MotionHistory {
    std::uint32_t count = 0;
    std::array<std::uint64_t, kSamplesKept> sample{};
    std::array<std::array<double, kAxesMax>, kSamplesKept> position{};
};
static_assert(std::is_trivially_copyable_v<MotionHistory>);

/// Adds a snapshot. One that is not newer than the newest: everything before it is forgotten.
/// @param stride  samples, at least 1: where they come faster than motion tells more
void note_snapshot(MotionHistory& history, const AxisSnapshot& snapshot,
                   std::uint32_t stride) noexcept;

/// How well the instants and the positions are known.
struct SampleErrors {
    double period_s = 0;           // nominal
    double period_share = 0;       // the period may be off by this share, all samples alike
    double latch_jitter_s = 0;     // and the time between the positions of two samples by this
    double position = 0;           // of a reported position against the true one at its latch
    bool is_jerk_limited = false;  // the axis keeps jerk_max in free motion too
};

/// A history at a closer spacing would tell little about acceleration: samples in one stride, 1 ms
/// or the next period.
[[nodiscard]] std::uint32_t history_stride(double period_s) noexcept;

/// The range of an axis, and whether the snapshots contradict what the axis is promised to keep to.
struct RangeFinding {
    AxisRange range;  // the whole range where they do
    // By how much the largest speed (acceleration) is below the smallest one; 0: no contradiction.
    double speed_gap = 0, acceleration_gap = 0;
};

/// @param is_unlimited  an endless axis, followed the short way round
/// Precondition: a snapshot was noted.
[[nodiscard]] RangeFinding find_range(const MotionHistory& history, std::uint32_t axis,
                                      const AxisLimits& limits, bool is_unlimited,
                                      const SampleErrors& errors) noexcept;

/// Everything the axis may be doing at the instant of the newest snapshot; its whole range where
/// the snapshots tell nothing, or contradict what the axis is promised to keep to. Precondition: a
/// snapshot was noted.
[[nodiscard]] AxisRange range_of(const MotionHistory& history, std::uint32_t axis,
                                 const Axis& promised, const SampleErrors& errors) noexcept;

}  // namespace axg
