// SPDX-License-Identifier: Apache-2.0
// How far two bodies can come closer while the axes stay in a box: the joints on the way from one
// to the other, and what each can move at most. Pure, double, no allocation; rounded outwards.
// Source: docs/theory/certificate.md, "From boxes to queries".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/limits.hpp"
#include "core/machine/kinematics.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// Every position the axes may take: centre +- half, mm or rad, in Machine::axes order. half >= 0.
struct JointBox {
    std::array<double, kAxesMax> centre{}, half{};
};

/// What a body's surface lies in, in its mesh frame: a box, and a ball about the box's middle.
struct BodyExtent {
    Vec3d low_mm, high_mm, middle_mm;
    double radius_mm = 0;
};
[[nodiscard]] BodyExtent extent_of(const Mesh& mesh) noexcept;

inline constexpr std::uint32_t kPathMax = kBodiesMax;

/// The moving joints between two bodies, from a's to b's: each joint by the body that it carries.
struct JointPath {
    std::uint32_t count = 0, count_a = 0;  // count_a: the first ones carry a, the others b
    std::array<std::uint32_t, kPathMax> body{};
};
[[nodiscard]] JointPath path_between(const Machine& machine, std::uint32_t a,
                                     std::uint32_t b) noexcept;

/// What the joints of a path can take from the distance of the two bodies, anywhere in a box.
struct PathMotion {
    double total_mm = 0;  // dist(q) >= dist(centre) - total_mm for every q in the box
    std::uint32_t widest_axis = kNoIndex;  // whose halves gain most; kNoIndex: nothing moves
};

/// Pose of a body at the centre of a joint box.
struct PlacedBody {
    const BodyExtent* extent = nullptr;
    Pose placed;  // its mesh frame in machine coordinates
};

/// How far from the axis of each rotary joint of a path any point of the body that it turns gets at
/// most, mm, wherever the axes are in a box: of the two bodies the one that is less far. Holds for
/// every box inside that one.
struct PathLevers {
    std::array<double, kPathMax> mm{};  // in the path's order; of a linear joint 0
};

/// @param moved  [bodies] motions at the box's centre (move_bodies)
/// Cost: nine distances of a point from a line, for each rotary joint of the path and each body.
[[nodiscard]] PathLevers levers_over(const Machine& machine, const JointPath& path,
                                     std::span<const Pose> moved, const PlacedBody& a,
                                     const PlacedBody& b, const JointBox& box) noexcept;

/// What the joints can take anywhere in a box of these half widths, inside the one of the levers.
/// @param half  [axes] mm or rad
/// Cost: a sine for each rotary joint of the path.
[[nodiscard]] PathMotion motion_by(const Machine& machine, const JointPath& path,
                                   const PathLevers& levers, std::span<const double> half) noexcept;

/// Both, of one box.
[[nodiscard]] PathMotion motion_along(const Machine& machine, const JointPath& path,
                                      std::span<const Pose> moved, const PlacedBody& a,
                                      const PlacedBody& b, const JointBox& box) noexcept;

}  // namespace axg
