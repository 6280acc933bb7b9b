// SPDX-License-Identifier: Apache-2.0
// How far sampled points of one surface get from another one. Shares no code with
// core/collision/deviation.cpp: the distance of a point from a triangle is the height over its
// plane where its foot is inside, and the least of the three edges' else. mm, double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "tests/support/surface_distance.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {

inline double square_of(Vec3d v) {
    return dot(v, v);
}

inline double square_from_edge(Vec3d p, Vec3d a, Vec3d b) {
    const Vec3d ab = b - a;
    const double length = square_of(ab);
    const double s = length > 0 ? std::clamp(dot(p - a, ab) / length, 0.0, 1.0) : 0.0;
    return square_of(p - (a + s * ab));
}

inline double square_from_facet(Vec3d p, const DistanceTree::Facet& f) {
    const Vec3d &a = f.v[0], &b = f.v[1], &c = f.v[2];
    const Vec3d n = cross(b - a, c - a);
    const double area = square_of(n);
    const bool is_over = area > 0 && dot(cross(b - a, p - a), n) >= 0 &&
                         dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
    if (is_over) {
        const double height = dot(p - a, n);
        return height * height / area;
    }
    return std::min(
        {square_from_edge(p, a, b), square_from_edge(p, b, c), square_from_edge(p, c, a)});
}

inline double square_from_box(Vec3d p, const DistanceTree::Aabb& box) {
    const double at[3] = {p.x, p.y, p.z};
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const double out = std::max(0.0, std::fabs(at[k] - box.c[k]) - box.h[k]);
        sum += out * out;
    }
    return sum;
}

/// The squared distance of p from the surface, or anything up to `enough` where it is not more.
inline double square_from_surface(Vec3d p, const DistanceTree& tree, double enough) {
    double least = std::numeric_limits<double>::infinity();
    std::array<std::uint32_t, 256> open{};
    std::size_t count = 1;
    while (count != 0 && least > enough) {
        const DistanceTree::Node& node = tree.nodes[open[--count]];
        if (square_from_box(p, node.box) >= least) {
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            least = std::min(least, square_from_facet(p, tree.facets[i]));
        }
        if (node.count == 0) {
            const bool is_first_nearer = square_from_box(p, tree.nodes[node.children[0]].box) <
                                         square_from_box(p, tree.nodes[node.children[1]].box);
            open[count++] = node.children[is_first_nearer ? 1 : 0];
            open[count++] = node.children[is_first_nearer ? 0 : 1];
        }
    }
    return least;
}

/// Of `count` points spread evenly over `surface`, and of its corners and the middles of its
/// triangles: the largest distance from `other`, mm.
inline double farthest_point_mm(const std::vector<Triangle>& surface, const DistanceTree& other,
                                std::uint64_t count, std::mt19937_64& random) {
    std::vector<double> areas;
    double farthest = 0;
    const auto look_at = [&](Vec3d p) {
        farthest = std::max(farthest, square_from_surface(p, other, farthest));
    };
    for (const Triangle& t : surface) {
        const Vec3d a = widen(t.a), b = widen(t.b), c = widen(t.c);
        areas.push_back(std::sqrt(square_of(cross(b - a, c - a))));
        for (const Vec3d p : {a, b, c, (1.0 / 3) * (a + b + c)}) {
            look_at(p);
        }
    }
    std::discrete_distribution<std::size_t> drawn(areas.begin(), areas.end());
    for (std::uint64_t i = 0; i < count; ++i) {
        const Triangle& t = surface[drawn(random)];
        double u = between(random, 0, 1), v = between(random, 0, 1);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const Vec3d a = widen(t.a);
        look_at(a + u * (widen(t.b) - a) + v * (widen(t.c) - a));
    }
    return std::sqrt(farthest);
}

}  // namespace axg::test
