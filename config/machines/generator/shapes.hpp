// SPDX-License-Identifier: Apache-2.0
// Outlines, and the few ways in which the parts are made of them.
#pragma once

#include <vector>

#include "config/machines/generator/polyhedron.hpp"
#include "config/machines/generator/triangulate.hpp"

namespace axg::generator {

/// A plane to draw in: u to the right, v up, u x v towards the viewer.
struct Plane {
    Vec3d origin, u, v;

    /// The point (p.x, p.y) of the plane, `height` mm towards the viewer.
    [[nodiscard]] Vec3d at(Point p, double height) const;
    [[nodiscard]] std::vector<Vec3d> at(const std::vector<Point>& p, double height) const;
};

inline constexpr Plane kPlaneXY{{}, {1, 0, 0}, {0, 1, 0}};  // seen from +z
inline constexpr Plane kPlaneYZ{{}, {0, 1, 0}, {0, 0, 1}};  // seen from +x
inline constexpr Plane kPlaneXZ{{}, {1, 0, 0}, {0, 0, 1}};  // seen from -y
inline constexpr Plane kPlaneZY{{}, {0, 0, 1}, {0, 1, 0}};  // seen from -x

/// A regular polygon around a circle: it touches the circle with the middles of its sides.
[[nodiscard]] std::vector<Point> around_circle(Point centre, double radius, std::uint32_t corners);
[[nodiscard]] std::vector<Point> rectangle(Point low, Point high);

/// An outline, with holes all the way through, between two heights of a plane.
[[nodiscard]] std::vector<Triangle> extrude(const Plane& plane, const std::vector<Point>& outline,
                                            double from, double to,
                                            const std::vector<std::vector<Point>>& holes = {});

/// Outlines of equal corner count at rising heights, joined by walls: the loops, lowest first. No
/// end faces.
[[nodiscard]] std::vector<Loop> stack(Polyhedron& solid, const Plane& plane,
                                      const std::vector<std::vector<Point>>& outlines,
                                      const std::vector<double>& heights);

/// A round part from its (radius, height) corners, lowest first, about +z; flat ends.
[[nodiscard]] std::vector<Triangle> solid_of_revolution(const std::vector<Point>& profile,
                                                        std::uint32_t corners);

}  // namespace axg::generator
