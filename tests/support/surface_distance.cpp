// SPDX-License-Identifier: Apache-2.0
#include "tests/support/surface_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace axg::test {
namespace {

double coordinate(Vec3d v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

double clamped(double t) {
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

double squared(Vec3d v) {
    return dot(v, v);
}

/// Nearest point of segment p q to x.
Vec3d nearest_on_segment(Vec3d p, Vec3d q, Vec3d x) {
    const Vec3d d = q - p;
    const double length2 = squared(d);
    return length2 > 0 ? p + clamped(dot(x - p, d) / length2) * d : p;
}

/// Squared distance of a vertex to a triangle: inside the prism over it to its plane, else to the
/// nearest edge. The foot of the perpendicular is taken only when it is inside by all three signs.
double vertex_to_triangle2(Vec3d x, const DistanceTree::Facet& t) {
    double best = std::numeric_limits<double>::infinity();
    const Vec3d normal = cross(t.v[1] - t.v[0], t.v[2] - t.v[0]);
    const double normal2 = squared(normal);
    bool inside = normal2 > 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3d p = t.v[i];
        const Vec3d q = t.v[(i + 1) % 3];
        best = std::min(best, squared(x - nearest_on_segment(p, q, x)));
        inside = inside && dot(cross(q - p, x - p), normal) >= 0;
    }
    if (inside) {
        const double height = dot(x - t.v[0], normal);
        best = std::min(best, height * height / normal2);
    }
    return best;
}

/// Squared distance of two segments. The unconstrained optimum is tried, then each end: one of the
/// five attains the minimum, and each is the distance of two real points.
double segments2(Vec3d p, Vec3d q, Vec3d r, Vec3d s) {
    double best = std::min(
        {squared(p - nearest_on_segment(r, s, p)), squared(q - nearest_on_segment(r, s, q)),
         squared(r - nearest_on_segment(p, q, r)), squared(s - nearest_on_segment(p, q, s))});
    const Vec3d d = q - p;
    const Vec3d e = s - r;
    const double dd = squared(d);
    const double de = dot(d, e);
    const double ee = squared(e);
    const double determinant = dd * ee - de * de;
    if (determinant > 0) {
        const Vec3d w = p - r;
        const double t = clamped((de * dot(e, w) - ee * dot(d, w)) / determinant);
        const Vec3d on_first = p + t * d;
        best = std::min(best, squared(on_first - nearest_on_segment(r, s, on_first)));
    }
    return best;
}

/// Whether segment p q meets the triangle's inside: its ends on both sides, and the line through.
bool passes_through(Vec3d p, Vec3d q, const DistanceTree::Facet& t) {
    const Vec3d normal = cross(t.v[1] - t.v[0], t.v[2] - t.v[0]);
    const double from = dot(p - t.v[0], normal);
    const double to = dot(q - t.v[0], normal);
    if ((from > 0 && to > 0) || (from < 0 && to < 0) || from == to) {
        return false;
    }
    const Vec3d x = p + (from / (from - to)) * (q - p);
    for (int i = 0; i < 3; ++i) {
        if (dot(cross(t.v[(i + 1) % 3] - t.v[i], x - t.v[i]), normal) < 0) {
            return false;
        }
    }
    return true;
}

/// A lower bound of the distance of two boxes: the widest gap along either box's own directions.
double box_gap(const DistanceTree::Aabb& a, const DistanceTree::Aabb& b, const Pose& pose) {
    const Vec3d centre = apply(pose, {a.c[0], a.c[1], a.c[2]});
    const Vec3d apart = centre - Vec3d{b.c[0], b.c[1], b.c[2]};
    double gap = 0;
    for (int i = 0; i < 3; ++i) {
        double along_b = std::abs(coordinate(apart, i)) - b.h[i];
        double along_a = -a.h[i];
        double projected = 0;
        for (int j = 0; j < 3; ++j) {
            along_b -= std::abs(pose.r[i][j]) * a.h[j];
            along_a -= std::abs(pose.r[j][i]) * b.h[j];
            projected += pose.r[j][i] * coordinate(apart, j);
        }
        gap = std::max({gap, along_b, std::abs(projected) + along_a});
    }
    return gap;
}

constexpr std::uint32_t kLeafCount = 4;

}  // namespace

DistanceTree::DistanceTree(const std::vector<Triangle>& triangles) {
    for (const Triangle& t : triangles) {
        facets.push_back({{widen(t.a), widen(t.b), widen(t.c)}});
    }
    build(0, static_cast<std::uint32_t>(facets.size()));
}

std::uint32_t DistanceTree::build(std::uint32_t first, std::uint32_t count) {
    const auto begin = facets.begin() + first;
    std::array<double, 3> low{};
    std::array<double, 3> high{};
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (auto facet = begin; facet != begin + count; ++facet) {
        for (const Vec3d& v : facet->v) {
            for (std::size_t i = 0; i < 3; ++i) {
                low[i] = std::min(low[i], coordinate(v, static_cast<int>(i)));
                high[i] = std::max(high[i], coordinate(v, static_cast<int>(i)));
            }
        }
    }
    Node node;
    int longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        node.box.c[i] = 0.5 * (low[i] + high[i]);
        node.box.h[i] = 0.5 * (high[i] - low[i]) * (1 + 1e-12) + 1e-12;
        longest = node.box.h[i] > node.box.h[longest] ? static_cast<int>(i) : longest;
    }
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(node);
    if (count <= kLeafCount) {
        nodes[index].first = first;
        nodes[index].count = count;
        return index;
    }
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, begin + count, [longest](const Facet& p, const Facet& q) {
        const Vec3d sum_p = p.v[0] + p.v[1] + p.v[2];
        const Vec3d sum_q = q.v[0] + q.v[1] + q.v[2];
        return coordinate(sum_p, longest) < coordinate(sum_q, longest);
    });
    const std::uint32_t left = build(first, half);
    const std::uint32_t right = build(first + half, count - half);
    nodes[index].children[0] = left;
    nodes[index].children[1] = right;
    return index;
}

double triangle_distance(const DistanceTree::Facet& a, const DistanceTree::Facet& b) {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const Vec3d p = a.v[i];
        const Vec3d q = a.v[(i + 1) % 3];
        if (passes_through(p, q, b) || passes_through(b.v[i], b.v[(i + 1) % 3], a)) {
            return 0;
        }
        best = std::min({best, vertex_to_triangle2(p, b), vertex_to_triangle2(b.v[i], a)});
        for (int j = 0; j < 3; ++j) {
            best = std::min(best, segments2(p, q, b.v[j], b.v[(j + 1) % 3]));
        }
    }
    return std::sqrt(best);
}

double surface_distance(const DistanceTree& a, const DistanceTree& b, const Pose& pose,
                        double cap_mm) {
    struct Task {
        std::uint32_t a, b;
        double gap;
    };
    double best = cap_mm;
    std::vector<Task> open{{0, 0, box_gap(a.nodes[0].box, b.nodes[0].box, pose)}};
    while (!open.empty() && best > 0) {
        const Task task = open.back();
        open.pop_back();
        // The bound has its own rounding: only what is farther by more than that is left out.
        if (task.gap > best + 1e-9) {
            continue;
        }
        const DistanceTree::Node& node_a = a.nodes[task.a];
        const DistanceTree::Node& node_b = b.nodes[task.b];
        if (node_a.count > 0 && node_b.count > 0) {
            for (std::uint32_t i = node_a.first; i < node_a.first + node_a.count; ++i) {
                DistanceTree::Facet placed = a.facets[i];
                for (Vec3d& v : placed.v) {
                    v = apply(pose, v);
                }
                for (std::uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
                    best = std::min(best, triangle_distance(placed, b.facets[j]));
                }
            }
            continue;
        }
        const auto size = [](const DistanceTree::Aabb& box) {
            return box.h[0] + box.h[1] + box.h[2];
        };
        const bool split_a =
            node_b.count > 0 || (node_a.count == 0 && size(node_a.box) > size(node_b.box));
        Task next[2];
        for (int k = 0; k < 2; ++k) {
            next[k].a = split_a ? node_a.children[k] : task.a;
            next[k].b = split_a ? task.b : node_b.children[k];
            next[k].gap = box_gap(a.nodes[next[k].a].box, b.nodes[next[k].b].box, pose);
        }
        const int nearer = next[0].gap <= next[1].gap ? 0 : 1;  // the nearer one is taken first
        open.push_back(next[1 - nearer]);
        open.push_back(next[nearer]);
    }
    return best;
}

}  // namespace axg::test
