// SPDX-License-Identifier: Apache-2.0
// Volume that a surface sweeps in a full turn: a cutter in a spindle whose angle is not
// reports.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec3.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/solid_of_revolution.hpp"

namespace axg {

// How far, in mm of radius, an outline of fewer points may stand off from the swept one, and the
// sides of the polygon from its circle.
inline constexpr double kSweptOutlineMm = 0.01, kSweptCircleMm = 0.02;

/// Outline, for solid_of_revolution(), of everything that the triangles reach when they turn about
/// +Z, and of all that lies between it and the axis: a hollow that opens downwards is filled, a
/// groove around is kept. Flat tops and steps are kept; radii are at most kSweptOutlineMm and 1e-6
/// of themselves larger where 255 stretches are enough for that, and 8,192 heights; a tip is 1 um
/// wide.
/// @param triangles  any, closed or not, at least one; their corners finite
[[nodiscard]] std::vector<Vec3d> swept_profile(std::span<const Triangle> triangles);

/// Sides that keep the polygon within kSweptCircleMm of the circle, where 256 are enough for that.
[[nodiscard]] std::uint32_t swept_segments(double radius_mm) noexcept;

/// A closed shell that contains all of it. Status: solid_of_revolution().
[[nodiscard]] RevolutionResult swept_solid(std::span<const Triangle> triangles);

}  // namespace axg
