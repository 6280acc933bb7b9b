// SPDX-License-Identifier: Apache-2.0
// Every position that the axes may have on a stretch of a path, or in a stop that begins there: a
// box in joint space, in whole units.
// Source: docs/theory/program.md; docs/reference/certificate-file.md, "What a checker computes".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/machine/machine.hpp"
#include "core/reach/joint_box.hpp"
#include "hil_replay/certify/chord_path.hpp"

namespace axg {

/// Places on a path are counted in this part of a segment.
inline constexpr std::uint64_t kPartsOfSegment = 256;

/// A stretch of a path, in parts of segments.
struct PathInterval {
    std::uint64_t begin = 0, end = 0;

    [[nodiscard]] std::uint64_t first_segment() const noexcept { return begin / kPartsOfSegment; }
    [[nodiscard]] std::uint64_t end_segment() const noexcept {
        return (end + kPartsOfSegment - 1) / kPartsOfSegment;
    }
};

/// Bounds of each axis in units; low <= high.
struct UnitBox {
    AxisUnits low{}, high{};
};
/// Exact: a bound is below 2^43, and a half of it is a double.
[[nodiscard]] JointBox joint_box(const Machine& machine, const UnitBox& box) noexcept;
/// Cuts the box in the middle of an axis. Both halves contain the middle.
[[nodiscard]] UnitBox half_of(const UnitBox& box, std::uint32_t axis, bool is_upper) noexcept;

/// How far an axis that moves at up to this speed may get in a stop, mm or rad, whenever the stop
/// begins; rounded up. Independent stops.
/// @param speed  of the command, in the direction of the way; >= 0
[[nodiscard]] double stop_way(const Machine& machine, std::uint32_t axis, double speed) noexcept;

class Tube {
  public:
    /// `machine` and `path` must outlive it.
    Tube(const Machine& machine, const ChordPath& path);

    /// Contains every position on the stretch, and of every stop that begins there. Cost: the
    /// logarithm of its length.
    [[nodiscard]] UnitBox box(const PathInterval& stretch) const noexcept;

  private:
    struct Rho {
        std::array<std::int64_t, 256> way{};  // [byte of a speed] units
    };
    void add_part(std::uint64_t segment, std::uint64_t from, std::uint64_t to,
                  UnitBox& box) const noexcept;
    void add_whole(std::uint64_t first, std::uint64_t end, UnitBox& box) const noexcept;

    const Machine& machine_;
    const ChordPath& path_;
    std::vector<Rho> rho_;                  // [axes]; empty: stops stay on the path
    std::uint64_t leaves_ = 1;              // of the tree over whole segments
    std::vector<std::int64_t> low_, high_;  // [2 leaves][axes]
};

}  // namespace axg
