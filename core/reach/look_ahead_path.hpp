// SPDX-License-Identifier: Apache-2.0
// The look-ahead path that a board sends: the commanded position of every axis at future instants,
// one per sample period. Computes how far along that path a stop can still go, and boxes around
// every position on the way. Pure; reserves all memory at create. mm and s, or rad and s.
// Source: docs/theory/certificate.md, "Look-ahead path".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include "core/base/arena.hpp"
#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/joint_box.hpp"
#include "core/reach/motion_history.hpp"
#include "core/reach/stop_reach.hpp"

namespace axg {

inline constexpr std::uint32_t kLookAheadSamplesMin = 4,
                               kLookAheadSamplesMax = 1024;  // periods that a board looks ahead
inline constexpr std::uint32_t kPathGapMax = 64;             // longest bridged gap, periods
inline constexpr std::uint32_t kPathLeaves = 64;             // smallest pieces of a stretch
inline constexpr std::uint32_t kPathPieces = 2 * kPathLeaves - 1;
inline constexpr std::uint32_t kReachLeaves = 8;  // smallest pieces of a reach
inline constexpr std::uint32_t kReachPieces = 2 * kReachLeaves - 1;

/// Contents of one frame: the commanded positions at two successive instants, so that the loss of
/// one frame loses no point.
struct PathPoints {
    std::uint64_t sample = 0;                 // of `position`
    std::array<double, kAxesMax> position{};  // endless axes in [0, one turn)
    std::array<double, kAxesMax> before{};    // at the sample before
};
static_assert(std::is_trivially_copyable_v<PathPoints>);

struct PathOptions {
    std::array<double, kAxesMax> count{};  // mm or rad of one count of the frames
};

/// The part of the path that a stop can still cover, in sample periods after the newest snapshot.
struct PathStretch {
    bool is_known = false;  // false: the look-ahead path ends before a stop must have ended
    double end = 0;
};

class LookAheadPath {
  public:
    /// `machine` must outlive it. Empty: out of memory.
    [[nodiscard]] static std::optional<LookAheadPath> create(const Machine& machine,
                                                             const PathOptions& options);

    /// Discards the path.
    void clear() noexcept { is_empty_ = true; }

    /// Adds the points of a frame and bridges lost points. False: the board sent another position
    /// for that instant before, or no axis within its limits can pass through these points;
    /// discards the earlier path. Cost: one pass over the last 24 points of each axis.
    bool note_path(const PathPoints& points) noexcept;

    [[nodiscard]] bool holds(std::uint64_t sample) const noexcept {
        return !is_empty_ && sample >= first_ && sample <= last_;
    }
    /// Precondition: holds(sample).
    [[nodiscard]] const std::array<double, kAxesMax>& at(std::uint64_t sample) const noexcept {
        return ring_[sample % ring_.size()].position;
    }

    /// Range of position, speed and acceleration of an axis one period before the last point.
    /// Empty: fewer than three points.
    [[nodiscard]] std::optional<AxisRange> end(std::uint32_t axis) const noexcept;

    /// Whether the axes are at the announced positions, within the following error, the position
    /// error and the motion during the latch jitter. True if the path does not cover that instant.
    [[nodiscard]] bool keeps_to(const AxisSnapshot& snapshot) const noexcept;

    /// The end of a stop that begins up to `free_s` after the instant of `sample`.
    /// Cost: one pass over the points up to that end.
    [[nodiscard]] PathStretch stretch(std::uint64_t sample, double free_s) const noexcept;

    /// Boxes around every position that the axes may have while the commands run from `sample` to
    /// `end` periods later. The children of piece i are 2 i + 1 and 2 i + 2; together they cover
    /// it. Precondition: stretch(sample, ..) returned is_known and this `end`.
    void cut(std::uint64_t sample, double end, std::span<JointBox, kPathPieces> out) const noexcept;

    /// Boxes around every position up to standstill if the axes follow the commands until a stop
    /// begins, up to `free_s` after the instant of `sample`, and then brake independently. The tree
    /// is as above, over the instants at which the stop may begin. False: the path ends earlier;
    /// `out` is unchanged.
    [[nodiscard]] bool reach(std::uint64_t sample, double free_s,
                             std::span<JointBox, kReachPieces> out) const noexcept;

    [[nodiscard]] std::size_t memory_bytes() const noexcept { return arena_.size(); }

  private:
    struct Point {
        std::array<double, kAxesMax> position;
        std::uint32_t gap;  // periods of the chord that ends at or contains this point
        bool is_bridge;
    };
    struct Ratios {
        double deceleration = 0, jerk = 0;  // largest |q'| / d and |q'| / j so far
    };

    LookAheadPath(const Machine& machine, const PathOptions& options, Arena arena) noexcept;
    [[nodiscard]] bool extend(const PathPoints& points) noexcept;
    [[nodiscard]] bool add(std::uint64_t sample,
                           const std::array<double, kAxesMax>& position) noexcept;
    [[nodiscard]] bool is_possible(std::uint64_t sample, std::uint32_t stride) const noexcept;
    [[nodiscard]] Point& point(std::uint64_t sample) noexcept {
        return ring_[sample % ring_.size()];
    }
    [[nodiscard]] const Point& point(std::uint64_t sample) const noexcept {
        return ring_[sample % ring_.size()];
    }
    [[nodiscard]] double step(std::uint32_t axis, double from, double to) const noexcept;
    [[nodiscard]] double speed_in_step(std::uint32_t axis, std::uint64_t sample) const noexcept;
    [[nodiscard]] double bulge(std::uint32_t axis, std::uint64_t sample) const noexcept;
    struct Latched {
        std::uint64_t first, last;  // samples
    };
    [[nodiscard]] Latched latched_at(std::uint64_t sample) const noexcept;
    [[nodiscard]] double off_path(std::uint32_t axis, double position,
                                  const Latched& at) const noexcept;
    struct Span {
        double low, high;
    };
    /// Up to two points whose two neighbours on either side were all sent.
    struct Middles {
        std::uint32_t count = 0;
        std::array<std::uint64_t, 2> sample{};
    };
    [[nodiscard]] bool is_middle(std::uint64_t sample) const noexcept;
    [[nodiscard]] Middles middles_about(std::uint64_t sample) const noexcept;
    [[nodiscard]] Span mean_acceleration(std::uint32_t axis, std::uint64_t middle) const noexcept;
    [[nodiscard]] Span acceleration_in_step(std::uint32_t axis, std::uint64_t sample,
                                            const Middles& middles) const noexcept;
    [[nodiscard]] AxisRange range_in_step(std::uint32_t axis, std::uint64_t sample,
                                          const Middles& middles, double from,
                                          double to) const noexcept;
    [[nodiscard]] AxisLimits limits_of(std::uint32_t axis) const noexcept;
    void join(std::span<JointBox> pieces) const noexcept;

    const Machine* machine_;
    PathOptions options_;
    double period_s_ = 0;
    std::array<double, kAxesMax> swing_{};  // largest acceleration relative to the commands
    Arena arena_;
    std::span<Point> ring_;
    bool is_empty_ = true;
    std::uint64_t first_ = 0, last_ = 0;
};

/// Length of path, in s of path time, that a stop covers from rate 1 to standstill. The rate falls
/// with a jerk of 1 / jerk_ratio up to a deceleration of 1 / deceleration_ratio. Never decreases
/// when a ratio increases.
[[nodiscard]] double path_braking_s(double deceleration_ratio, double jerk_ratio) noexcept;

}  // namespace axg
