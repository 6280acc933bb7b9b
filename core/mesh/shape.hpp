// SPDX-License-Identifier: Apache-2.0
// Boxes and solids of revolution that a surface is put together from: fixtures, workpieces, the
// sections of a tool. mm. Init only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/vec3.hpp"
#include "core/mesh/solid_of_revolution.hpp"

namespace axg {

struct Shape {
    Vec3d box_mm{};              // extent; from z = 0 upwards, centred in x and y
    std::vector<Vec3d> profile;  // empty: the box. Revolved about +Z: x = radius, z = height
    std::uint32_t segments = 48;
    Pose at;                  // to the frame of the surface
    std::string name;         // of a tool's section, else empty
    bool is_cutting = false;  // of a tool's section: it may touch the stock
    bool turns = false;       // of a tool's section: all that it sweeps about +Z counts
    std::string key;          // "tools.2.profile_mm", for messages
    std::string where;        // "machine.yaml:14"
};

/// Outline of a cone with its base at z = 0; a cylinder if both radii are equal. All values are
/// above 0, except a top of 0: a tip.
[[nodiscard]] std::vector<Vec3d> cone_profile(double radius_mm, double top_radius_mm,
                                              double height_mm);

/// Outline of a sphere about the origin, circumscribed: its sides touch the circle. The error of it
/// and `solid_of_revolution` together is at most r (1/cos^2(pi/segments) - 1) + 6e-6 r.
[[nodiscard]] std::vector<Vec3d> sphere_profile(double radius_mm, std::uint32_t segments);

/// A closed shell that contains the shape, or, if it turns, all that it sweeps about +Z of the
/// surface's frame (swept_solid()), except for the rounding of its corners to float32: each
/// coordinate is off by at most 2^-23 of the largest one. Status and point: solid_of_revolution().
[[nodiscard]] RevolutionResult triangles_of(const Shape& shape);

}  // namespace axg
