// SPDX-License-Identifier: Apache-2.0
// Bounds how far two bodies can approach each other while the axes stay in a box: the joints on the
// path between them, and the largest motion of each. Pure, double, no allocation; rounded outwards.
// Source: docs/theory/certificate.md, "From boxes to queries".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/limits.hpp"
#include "core/machine/kinematics.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"
#include "core/reach/joint_box.hpp"

namespace axg {

/// Bounds of a body's surface in its mesh frame: a box, and a ball about the box's middle.
struct BodyExtent {
    Vec3d low_mm, high_mm, middle_mm;
    double radius_mm = 0;
};
[[nodiscard]] BodyExtent extent_of(const Mesh& mesh) noexcept;

inline constexpr std::uint32_t kPathMax = kBodiesMax;

/// The moving joints between two bodies, from a's to b's, each identified by the body it carries.
struct JointPath {
    std::uint32_t count = 0, count_a = 0;  // the first count_a joints carry a, the others b
    std::array<std::uint32_t, kPathMax> body{};
};
[[nodiscard]] JointPath path_between(const Machine& machine, std::uint32_t a,
                                     std::uint32_t b) noexcept;

/// Whether the box contains the positions, on the axes of the path; of an endless axis in any turn.
[[nodiscard]] bool is_in_box_any_turn(const Machine& machine, const JointPath& path,
                                      const JointBox& box,
                                      std::span<const double> position) noexcept;

/// Bound of how much the joints of a path can reduce the distance of the two bodies in a box.
struct PathMotion {
    double total_mm = 0;  // dist(q) >= dist(centre) - total_mm for every q in the box
    std::uint32_t widest_axis = kNoIndex;  // the best axis to split; kNoIndex: no motion
};

/// Pose of a body at the centre of a joint box.
struct PlacedBody {
    const BodyExtent* extent = nullptr;
    Pose placed;  // its mesh frame in machine coordinates
};

/// Lever of each rotary joint of a path: largest distance, mm, of any point of a body from the
/// joint's axis, anywhere in a box; the smaller lever of the two bodies. Valid for every box inside
/// that one.
struct PathLevers {
    std::array<double, kPathMax> mm{};  // in the path's order; 0 for a linear joint
};

/// @param moved  [bodies] motions at the box's centre (move_bodies)
/// Cost: nine point-line distances for each rotary joint of the path and each body.
[[nodiscard]] PathLevers levers_over(const Machine& machine, const JointPath& path,
                                     std::span<const Pose> moved, const PlacedBody& a,
                                     const PlacedBody& b, const JointBox& box) noexcept;

/// The motion in a box of these half widths. Precondition: it is inside the box of the levers.
/// @param half  [axes] mm or rad
/// Cost: a sine for each rotary joint of the path.
[[nodiscard]] PathMotion motion_by(const Machine& machine, const JointPath& path,
                                   const PathLevers& levers, std::span<const double> half) noexcept;

/// levers_over and motion_by for one box.
[[nodiscard]] PathMotion motion_along(const Machine& machine, const JointPath& path,
                                      std::span<const Pose> moved, const PlacedBody& a,
                                      const PlacedBody& b, const JointBox& box) noexcept;

}  // namespace axg
