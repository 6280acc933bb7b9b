// SPDX-License-Identifier: Apache-2.0
// The solid of revolution of a tool's profile about +Z: a closed polyhedron that contains the round
// body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg {

inline constexpr std::uint32_t kProfilePointsMax = 512;
inline constexpr std::uint32_t kProfileSegmentsMin = 8, kProfileSegmentsMax = 512;

enum class RevolutionStatus : std::uint8_t {
    ok,
    bad_segments,       // outside kProfileSegmentsMin..Max
    bad_point_count,    // fewer than 3 points, or more than kProfilePointsMax
    bad_point,          // not finite, beyond kCoordinateMmMax, or of negative radius
    ends_off_axis,      // the first and last point must have radius 0
    touches_axis,       // a point between them has radius 0
    repeated_point,     // two points in a row are equal once rounded to float32
    crosses_itself,     // the outline is no simple polygon
    groove_too_narrow,  // a groove in an end face that the polygon's error would close: see below
};

struct RevolutionResult {
    RevolutionStatus status = RevolutionStatus::ok;
    std::uint32_t point = 0;  // index of the first point meant by the status
    std::vector<Triangle> triangles;
};

/// @param profile   outline from axis to axis, either way round: x = radius mm, z = height mm; y
/// unused
/// @param segments  corners of the polygon that replaces the circle
/// @return          closed, outward facing; contains the solid of revolution of the profile, whose
///                  points are first rounded to float32. Outer walls are offset by at
///                  most r (1/cos(pi/segments) - 1) + 2e-6 r, inner ones (that face the axis: a
///                  bore, a hollow) likewise towards the axis.
///                  Proof in solid_of_revolution.cpp.
[[nodiscard]] RevolutionResult solid_of_revolution(std::span<const Vec3d> profile,
                                                   std::uint32_t segments);

}  // namespace axg
