// SPDX-License-Identifier: Apache-2.0
#include "core/collision/winding.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/assert.hpp"
#include "core/base/exact_sign.hpp"

namespace axg {
namespace {

/// A ray from the point along axis k, upwards or downwards; i, j, k are in cyclic order, so that
/// permuting the axes preserves every orientation.
struct Ray {
    int i = 0, j = 1, k = 2;
    double sign = 1;
    double p_i = 0, p_j = 0, p_k = 0;
};

/// One corner, its coordinates in the order of the ray's axes.
struct Corner {
    double i, j, k;
};

Ray shortest_ray(const Aabb& box, const Vec3d& point) noexcept {
    const double p[3] = {point.x, point.y, point.z};
    Ray ray;
    double shortest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        for (const double sign : {1.0, -1.0}) {
            const double way = double(box.h[k]) + sign * (double(box.c[k]) - p[k]);
            if (way < shortest) {
                shortest = way;
                ray.k = k;
                ray.sign = sign;
            }
        }
    }
    ray.i = (ray.k + 1) % 3;
    ray.j = (ray.k + 2) % 3;
    ray.p_i = p[ray.i];
    ray.p_j = p[ray.j];
    ray.p_k = p[ray.k];
    return ray;
}

/// Children whose boxes the ray meets, one bit each. A box holds its triangles exactly, and a
/// rounded difference that exceeds a float h exceeds it unrounded: none is missed.
std::uint32_t children_on(const Ray& ray, const TreeNode& node) noexcept {
    const float *const c_i = node.c[ray.i], *const c_j = node.c[ray.j], *const c_k = node.c[ray.k];
    const float *const h_i = node.h[ray.i], *const h_j = node.h[ray.j], *const h_k = node.h[ray.k];
    std::uint32_t bits = 0;
    for (unsigned n = 0; n < node.count; ++n) {
        const bool is_beside = std::fabs(ray.p_i - double(c_i[n])) > double(h_i[n]) ||
                               std::fabs(ray.p_j - double(c_j[n])) > double(h_j[n]);
        const bool is_behind = ray.sign * (ray.p_k - double(c_k[n])) > double(h_k[n]);
        bits |= (is_beside || is_behind ? 0U : 1U) << n;
    }
    return bits;
}

/// Sign of (a - p) x (b - p) in the plane of i and j: 1 if p is left of the line from a to b.
int side_of_edge(const Ray& ray, const Corner& a, const Corner& b, RayWork& work) noexcept {
    const ExactSign found = sign_of_turn({two_sum(a.i, -ray.p_i), two_sum(a.j, -ray.p_j)},
                                         {two_sum(b.i, -ray.p_i), two_sum(b.j, -ray.p_j)});
    work.exact_signs += found.is_summed ? 1 : 0;
    return found.sign;
}

/// Whether the edge from a to b passes the half line from the point in direction +i: 1 upwards (in
/// j), -1 downwards. A corner level with the point counts as below it, and an edge through the
/// point as left of it: as if the point moved a little along +i, and much less along +j.
int crossing(const Ray& ray, const Corner& a, const Corner& b, RayWork& work) noexcept {
    const bool a_above = a.j > ray.p_j, b_above = b.j > ray.p_j;
    if (a_above == b_above) {
        return 0;
    }
    const int up = b_above ? 1 : -1;
    if (a.i <= ray.p_i && b.i <= ray.p_i) {
        return 0;
    }
    if (a.i > ray.p_i && b.i > ray.p_i) {
        return up;
    }
    return side_of_edge(ray, a, b, work) == up ? up : 0;
}

/// Sign of the determinant of (a - p, b - p, c - p).
int side_of_plane(const Ray& ray, const std::array<Corner, 3>& v, RayWork& work) noexcept {
    std::array<std::array<TwoTerms, 3>, 3> rows;
    for (std::size_t n = 0; n < 3; ++n) {
        rows[n] = {two_sum(v[n].i, -ray.p_i), two_sum(v[n].j, -ray.p_j), two_sum(v[n].k, -ray.p_k)};
    }
    const ExactSign found = sign_of_volume(rows);
    work.exact_signs += found.is_summed ? 1 : 0;
    return found.sign;
}

/// Adds the contribution of triangle n of a leaf. False: the point is on the triangle.
bool add_triangle(const Ray& ray, const TreeLeaf& leaf, unsigned n, Winding& out,
                  RayWork& work) noexcept {
    std::array<Corner, 3> v;
    for (std::size_t m = 0; m < 3; ++m) {
        const auto at = [&](int axis) {
            return double(leaf.v[3 * m + static_cast<std::size_t>(axis)][n]);
        };
        v[m] = {at(ray.i), at(ray.j), at(ray.k)};
    }
    const int turn = crossing(ray, v[0], v[1], work) + crossing(ray, v[1], v[2], work) +
                     crossing(ray, v[2], v[0], work);
    if (turn == 0) {
        return true;  // the line of the ray passes it by
    }
    const int side = side_of_plane(ray, v, work);
    const int direction = ray.sign > 0 ? 1 : -1;
    if (side * turn * direction > 0) {  // not behind the point
        out.number += direction * turn;
    }
    return side != 0;
}

void check_capacities(const Capacities& capacities, RayWork& work) noexcept {
    if (work.nodes > capacities.node_pairs) {
        work.status = QueryStatus::too_many_node_pairs;
    } else if (work.triangles > capacities.triangle_pairs) {
        work.status = QueryStatus::too_many_triangle_pairs;
    } else if (work.exact_signs > pose_rechecks(capacities)) {
        work.status = QueryStatus::too_many_rechecks;
    }
}

}  // namespace

std::vector<std::uint32_t> closed_masks(std::span<const TreeNode> nodes,
                                        std::span<const TreeLeaf> leaves,
                                        std::span<const std::uint8_t> is_closed) {
    std::vector<std::uint32_t> masks(leaves.size());
    for (const TreeNode& node : nodes) {
        for (std::uint32_t i = 0; node.leaf != kNoLeaf && i < node.count; ++i) {
            masks[node.leaf] |= std::uint32_t{is_closed[leaves[node.leaf].triangle[i]]} << i;
        }
    }
    return masks;
}

Winding winding_number(const Solid& solid, const Vec3d& point, const Capacities& capacities,
                       RayWork& work) noexcept {
    const TreeNode* const nodes = solid.tree.nodes.data();
    const Ray ray = shortest_ray(nodes[0].box, point);
    std::array<std::uint32_t, std::size_t{kTreeDepthMax} * kNodeWidth> open;
    std::size_t open_count = 1;
    open[0] = 0;
    Winding out;
    while (open_count != 0) {
        const TreeNode& node = nodes[open[--open_count]];
        ++work.nodes;
        std::uint32_t bits = children_on(ray, node);
        const bool is_leaf = node.leaf != kNoLeaf;
        bits &= is_leaf ? solid.closed[node.leaf] : ~0U;
        AXG_ASSERT(open_count + kNodeWidth <= open.size());
        for (; bits != 0; bits &= bits - 1) {
            const auto n = static_cast<unsigned>(__builtin_ctz(bits));
            if (!is_leaf) {
                open[open_count++] = node.first_child + n;
                continue;
            }
            ++work.triangles;
            if (!add_triangle(ray, solid.tree.leaves[node.leaf], n, out, work)) {
                return out;
            }
        }
        check_capacities(capacities, work);
        if (work.status != QueryStatus::ok) {
            return out;
        }
    }
    out.is_known = true;
    return out;
}

}  // namespace axg
