// SPDX-License-Identifier: Apache-2.0
// Volume that a surface sweeps in a full turn: a cutter in a spindle whose angle is not reported.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec3.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/solid_of_revolution.hpp"

namespace axg {

// Largest distance, in mm of radius, of an outline of fewer points from the swept one, and of the
// polygon from its circle.
inline constexpr double kSweptOutlineMm = 0.01, kSweptCircleMm = 0.02;

/// Outline, for solid_of_revolution(), of everything that the triangles reach when they turn about
/// +Z, and of all between that and the axis: fills a hollow that opens downwards, preserves a
/// groove around. Preserves flat tops and steps. Radii are at most kSweptOutlineMm and 1e-6 of
/// themselves larger, if 255 stretches and 8,192 heights suffice. A tip has a radius of 1 um.
/// @param triangles  any, closed or not, at least one; their corners finite
[[nodiscard]] std::vector<Vec3d> swept_profile(std::span<const Triangle> triangles);

/// Sides for a polygon within kSweptCircleMm of the circle; at most 256, even if more are needed.
[[nodiscard]] std::uint32_t swept_segments(double radius_mm) noexcept;

/// A closed shell that contains the swept volume. Status: solid_of_revolution().
[[nodiscard]] RevolutionResult swept_solid(std::span<const Triangle> triangles);

}  // namespace axg
