// SPDX-License-Identifier: Apache-2.0
#include "config/machines/generator/polyhedron.hpp"

#include <algorithm>
#include <cmath>

#include "config/machines/generator/triangulate.hpp"

namespace axg::generator {
namespace {

/// Twice the area vector of a loop. Source: Newell's method.
Vec3d area_vector(const std::vector<Vec3d>& corner, const Loop& loop) {
    Vec3d sum;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3d origin = corner[loop[0]];
        sum = sum + cross(corner[loop[i]] - origin, corner[loop[(i + 1) % loop.size()]] - origin);
    }
    return sum;
}

Vec3f round_to_float(Vec3d p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

}  // namespace

Loop reversed(const Loop& loop) {
    return {loop.rbegin(), loop.rend()};
}

Loop Polyhedron::ring(const std::vector<Vec3d>& corners) {
    Loop loop;
    for (const Vec3d& p : corners) {
        loop.push_back(static_cast<std::uint32_t>(corner_.size()));
        corner_.push_back(p);
    }
    return loop;
}

void Polyhedron::face(const Loop& outer, const std::vector<Loop>& holes) {
    const Vec3d normal = area_vector(corner_, outer);
    Face added{outer, holes};
    for (Loop& hole : added.holes) {
        if (dot(area_vector(corner_, hole), normal) > 0) {
            hole = reversed(hole);
        }
    }
    face_.push_back(added);
}

void Polyhedron::wall(const Loop& from, const Loop& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
        const std::size_t next = (i + 1) % from.size();
        face({from[i], from[next], to[next], to[i]});
    }
}

std::vector<Triangle> Polyhedron::triangles() const {
    std::vector<Triangle> out;
    for (const Face& f : face_) {
        const Vec3d normal = area_vector(corner_, f.outer);
        // Looked at along the largest component of the normal, turned so that the face stays
        // counter-clockwise.
        const double ax = std::fabs(normal.x), ay = std::fabs(normal.y), az = std::fabs(normal.z);
        std::vector<Point> flat;
        for (const Vec3d& p : corner_) {
            if (az >= ax && az >= ay) {
                flat.push_back({normal.z > 0 ? p.x : -p.x, p.y});
            } else if (ax >= ay) {
                flat.push_back({normal.x > 0 ? p.y : -p.y, p.z});
            } else {
                flat.push_back({normal.y > 0 ? p.z : -p.z, p.x});
            }
        }
        std::vector<Loop> loops{f.outer};
        loops.insert(loops.end(), f.holes.begin(), f.holes.end());
        const auto cut = triangulate(flat, loops);
        if (cut.empty()) {
            return {};
        }
        for (const auto& t : cut) {
            out.push_back({round_to_float(corner_[t[0]]), round_to_float(corner_[t[1]]),
                           round_to_float(corner_[t[2]])});
        }
    }
    return out;
}

}  // namespace axg::generator
