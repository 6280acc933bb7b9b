// SPDX-License-Identifier: Apache-2.0
#include "config/machines/generator/shapes.hpp"

#include "core/base/sincos.hpp"

namespace axg::generator {

Vec3d Plane::at(Point p, double height) const {
    return origin + p.x * u + p.y * v + height * cross(u, v);
}

std::vector<Vec3d> Plane::at(const std::vector<Point>& p, double height) const {
    std::vector<Vec3d> out;
    for (const Point& q : p) {
        out.push_back(at(q, height));
    }
    return out;
}

std::vector<Point> around_circle(Point centre, double radius, std::uint32_t corners) {
    const double half = kPi / static_cast<double>(corners);
    const double corner_radius = radius / sin_cos(half).cos;
    std::vector<Point> out;
    for (std::uint32_t k = 0; k < corners; ++k) {
        const SinCos direction = sin_cos((2.0 * static_cast<double>(k) + 1.0) * half);
        out.push_back(
            {centre.x + corner_radius * direction.cos, centre.y + corner_radius * direction.sin});
    }
    return out;
}

std::vector<Point> rectangle(Point low, Point high) {
    return {low, {high.x, low.y}, high, {low.x, high.y}};
}

std::vector<Loop> stack(Polyhedron& solid, const Plane& plane,
                        const std::vector<std::vector<Point>>& outlines,
                        const std::vector<double>& heights) {
    std::vector<Loop> loops;
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        loops.push_back(solid.ring(plane.at(outlines[i], heights[i])));
        if (i > 0) {
            solid.wall(loops[i - 1], loops[i]);
        }
    }
    return loops;
}

std::vector<Triangle> extrude(const Plane& plane, const std::vector<Point>& outline, double from,
                              double to, const std::vector<std::vector<Point>>& holes) {
    Polyhedron solid;
    const std::vector<Loop> outside = stack(solid, plane, {outline, outline}, {from, to});
    std::vector<Loop> low, high;
    for (const std::vector<Point>& hole : holes) {
        low.push_back(solid.ring(plane.at(hole, from)));
        high.push_back(solid.ring(plane.at(hole, to)));
        solid.wall(reversed(low.back()), reversed(high.back()));
    }
    solid.face(reversed(outside[0]), low);
    solid.face(outside[1], high);
    return solid.triangles();
}

std::vector<Triangle> solid_of_revolution(const std::vector<Point>& profile,
                                          std::uint32_t corners) {
    Polyhedron solid;
    std::vector<std::vector<Point>> outlines;
    std::vector<double> heights;
    for (const Point& p : profile) {
        outlines.push_back(around_circle({0, 0}, p.x, corners));
        heights.push_back(p.y);
    }
    const std::vector<Loop> loops = stack(solid, kPlaneXY, outlines, heights);
    solid.face(reversed(loops.front()));
    solid.face(loops.back());
    return solid.triangles();
}

}  // namespace axg::generator
