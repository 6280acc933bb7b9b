// SPDX-License-Identifier: Apache-2.0
// Forward kinematics of the tree of bodies: axis positions in, one placement a body out. Pure,
// double, no allocation.
#pragma once

#include <span>

#include "core/machine/machine.hpp"

namespace axg {

/// The motion of one joint at position q (mm or rad), in machine coordinates.
/// Rotary: |q| <= kSinCosArgumentMax.
[[nodiscard]] Pose joint_motion(const Axis& axis, const Joint& joint, double q) noexcept;

/// Placements of all bodies' meshes in machine coordinates.
///
/// @param position  [axes] mm or rad, in Machine::axes order
/// @param placed    [bodies] out; placed[i] maps body i's mesh frame to machine coordinates
/// Cost: one joint motion and two compositions a body.
void place_bodies(const Machine& machine, std::span<const double> position,
                  std::span<Pose> placed) noexcept;

/// The same without the mesh frames: the motion of each body away from its zero pose.
/// @param moved  [bodies] out
void move_bodies(const Machine& machine, std::span<const double> position,
                 std::span<Pose> moved) noexcept;

/// Bound of the rounding of any coordinate of a body placed in another's frame, mm: 64 products of
/// poses, each a few roundings of numbers up to 8 kCoordinateMmMax, add less than half of it.
inline constexpr double kPlacementErrorMm = 0x1p-23;

/// Body a's mesh frame expressed in body b's mesh frame.
[[nodiscard]] Pose relative_pose(const Pose& placed_a, const Pose& placed_b) noexcept;

}  // namespace axg
