// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/witness_walk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/collision/closest_direction.hpp"

namespace axg {
namespace {

double along(const Vec3d& direction, const float (&half)[3]) noexcept {
    return std::fabs(direction.x) * double(half[0]) + std::fabs(direction.y) * double(half[1]) +
           std::fabs(direction.z) * double(half[2]);
}

Vec3d middle(const Aabb& box) noexcept {
    return {box.c[0], box.c[1], box.c[2]};
}

float size_of_box(const Aabb& box) noexcept {
    return box.h[0] + box.h[1] + box.h[2];
}

Triangle triangle_of(const TreeLeaf& leaf, std::uint32_t i) noexcept {
    return {{leaf.v[0][i], leaf.v[1][i], leaf.v[2][i]},
            {leaf.v[3][i], leaf.v[4][i], leaf.v[5][i]},
            {leaf.v[6][i], leaf.v[7][i], leaf.v[8][i]}};
}

/// The least and the largest place of each triangle of a leaf along a direction.
struct LeafSpan {
    std::array<double, kNodeWidth> low{}, high{};
};

LeafSpan span_of(const TreeLeaf& leaf, const Vec3d& d) noexcept {
    LeafSpan out;
    for (std::uint32_t i = 0; i < kNodeWidth; ++i) {
        std::array<double, 3> at{};
        for (std::uint32_t k = 0; k < 3; ++k) {
            at[k] = d.x * double(leaf.v[3 * k][i]) + d.y * double(leaf.v[3 * k + 1][i]) +
                    d.z * double(leaf.v[3 * k + 2][i]);
        }
        out.low[i] = std::min({at[0], at[1], at[2]});
        out.high[i] = std::max({at[0], at[1], at[2]});
    }
    return out;
}

}  // namespace

Vec3f direction_between(const Triangle& a, const Triangle& b, const Pose& pose) {
    sat::TrianglePair<double> p{};
    const std::array<Vec3f, 3> of_a{a.a, a.b, a.c}, of_b{b.a, b.b, b.c};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d at = apply(pose, widen(of_a[i])), to = widen(of_b[i]);
        p.a[i] = {at.x, at.y, at.z};
        p.b[i] = {to.x, to.y, to.z};
    }
    const sat::V3<double> d = sat::closest_direction(p, sat::axes_of(p)).direction;
    const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const double unit = length > 0 ? 1 / length : 0;
    return {static_cast<float>(d.x * unit), static_cast<float>(d.y * unit),
            static_cast<float>(d.z * unit)};
}

void WitnessWalk::add(const PlacedSurfaces& at, double r_mm, Vec3f direction) {
    Turned turned;
    turned.in_b = widen(direction);
    turned.in_a = rotate(inverse(at.pose), turned.in_b);
    turned.shift = dot(turned.in_b, Vec3d{at.pose.t[0], at.pose.t[1], at.pose.t[2]});
    turned.needed = r_mm * std::sqrt(dot(turned.in_b, turned.in_b));
    turned_.push_back(turned);
}

bool WitnessWalk::are_apart(const Aabb& a, const Aabb& b) const noexcept {
    for (const Turned& t : turned_) {
        const double high = t.shift + dot(t.in_a, middle(a)) + along(t.in_a, a.h);
        const double low = dot(t.in_b, middle(b)) - along(t.in_b, b.h);
        if (low - high > t.needed) {
            return true;
        }
    }
    return false;
}

/// @param may_add  a pair of triangles that is still open adds its own direction
bool WitnessWalk::judge_leaves(const PlacedSurfaces& at, double r_mm, const TreeNode& a,
                               const TreeNode& b, Directions& directions, bool may_add) {
    const TreeLeaf &leaf_a = at.a->leaves[a.leaf], &leaf_b = at.b->leaves[b.leaf];
    std::array<std::uint32_t, kNodeWidth> open{};  // a bit a triangle of b
    const std::uint32_t all =
        b.count == kNodeWidth ? UINT32_MAX : (std::uint32_t{1} << b.count) - 1;
    std::fill_n(open.begin(), a.count, all);
    const auto close_by = [&](const Turned& t) {
        const LeafSpan of_a = span_of(leaf_a, t.in_a), of_b = span_of(leaf_b, t.in_b);
        for (std::uint32_t i = 0; i < a.count; ++i) {
            const double least = of_a.high[i] + t.shift + t.needed;
            std::uint32_t apart = 0;
            for (std::uint32_t j = 0; j < kNodeWidth; ++j) {
                apart |= (of_b.low[j] > least ? 1U : 0U) << j;
            }
            open[i] &= ~apart;
        }
    };
    for (const Turned& t : turned_) {
        close_by(t);
    }
    for (std::uint32_t i = 0; i < a.count; ++i) {
        while (open[i] != 0) {
            if (!may_add || directions.size() == kDirectionsMax) {
                return false;
            }
            const auto j = static_cast<std::uint32_t>(std::countr_zero(open[i]));
            directions.push_back(
                direction_between(triangle_of(leaf_a, i), triangle_of(leaf_b, j), at.pose));
            add(at, r_mm, directions.back());
            close_by(turned_.back());
            if ((open[i] >> j & 1U) != 0) {
                return false;  // these two are nearer
            }
        }
    }
    return true;
}

bool WitnessWalk::walk(const PlacedSurfaces& at, double r_mm, Directions& directions,
                       bool may_add) {
    turned_.clear();
    for (const Vec3f& direction : directions) {
        add(at, r_mm, direction);
    }
    open_.assign(1, {0, 0});
    for (std::uint32_t pairs = 0; !open_.empty(); ++pairs) {
        const auto [place_a, place_b] = open_.back();
        open_.pop_back();
        const TreeNode &a = at.a->nodes[place_a], &b = at.b->nodes[place_b];
        if (are_apart(a.box, b.box)) {
            continue;
        }
        if (pairs >= kWalkPairsMax) {
            return false;
        }
        const bool is_leaf_a = a.leaf != kNoLeaf, is_leaf_b = b.leaf != kNoLeaf;
        if (is_leaf_a && is_leaf_b) {
            if (!judge_leaves(at, r_mm, a, b, directions, may_add)) {
                return false;
            }
            continue;
        }
        const bool opens_a = !is_leaf_a && (is_leaf_b || size_of_box(a.box) >= size_of_box(b.box));
        for (std::uint32_t i = 0; i < (opens_a ? a.count : b.count); ++i) {
            open_.emplace_back(opens_a ? a.first_child + i : place_a,
                               opens_a ? place_b : b.first_child + i);
        }
    }
    return true;
}

bool WitnessWalk::proves(const PlacedSurfaces& at, double r_mm, const Directions& directions) {
    Directions given = directions;
    return walk(at, r_mm, given, false);
}

bool WitnessWalk::complete(const PlacedSurfaces& at, double r_mm, Directions& directions) {
    return walk(at, r_mm, directions, true);
}

}  // namespace axg
