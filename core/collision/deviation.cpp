// SPDX-License-Identifier: Apache-2.0
#include "core/collision/deviation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/limits.hpp"
#include "core/base/vec3.hpp"
#include "core/collision/tree.hpp"

namespace axg {

namespace {

// Most cuts of a triangle through its longest edge: a piece is then a 4096th of its size.
constexpr int kCutsMax = 24;
constexpr std::size_t kAllCutsMax = 1U << 12U;  // of one triangle
constexpr int kHalvings = 7;                    // of the interval between proven and not proven
// Each corner, closest point and length below is off by less than a hundred roundings of the
// largest coordinate.
constexpr double kRoundingMm = 0x1p-45 * kCoordinateMmMax;

using Corners = std::array<Vec3d, 3>;

struct Piece {
    Corners corners;
    int cuts = 0;
};

Corners corners_of(const Triangle& t) noexcept {
    return {widen(t.a), widen(t.b), widen(t.c)};
}

double length(Vec3d v) noexcept {
    return std::sqrt(dot(v, v));
}

/// The point at the fraction `s` of the way from a to b, s in [0, 1].
Vec3d between(Vec3d a, Vec3d b, double s) noexcept {
    return a + s * (b - a);
}

double share(double part, double rest) noexcept {
    const double sum = part + rest;
    return sum > 0 ? std::clamp(part / sum, 0.0, 1.0) : 0.0;
}

/// A point of the triangle that is about the nearest one to p. A bound only needs it to be a point
/// of the triangle. Source: Ericson, Real-Time Collision Detection, 5.1.5.
Vec3d near_point(Vec3d p, const Corners& t) noexcept {
    const Vec3d ab = t[1] - t[0], ac = t[2] - t[0];
    const Vec3d ap = p - t[0], bp = p - t[1], cp = p - t[2];
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) {
        return t[0];
    }
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) {
        return t[1];
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        return between(t[0], t[1], share(d1, -d3));
    }
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) {
        return t[2];
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        return between(t[0], t[2], share(d2, -d6));
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return between(t[1], t[2], share(d4 - d3, d5 - d6));
    }
    // Towards c from where the line through c and the point cuts ab: two shares in [0, 1], so that
    // the point stays on the triangle whatever the quotients lost.
    return between(between(t[0], t[1], share(vb, va)), t[2], share(vc, va + vb));
}

/// At least the distance of p from the triangle.
double distance_up(Vec3d p, const Corners& t) noexcept {
    return length(p - near_point(p, t)) + kRoundingMm;
}

struct Range {
    double c[3], h[3];
};

Range range_of(const Corners& t) noexcept {
    Range out{};
    const auto take = [&out, &t](int k, auto of) {
        const auto [low, high] = std::minmax({of(t[0]), of(t[1]), of(t[2])});
        out.c[k] = 0.5 * (low + high);
        out.h[k] = 0.5 * (high - low);
    };
    take(0, [](Vec3d v) { return v.x; });
    take(1, [](Vec3d v) { return v.y; });
    take(2, [](Vec3d v) { return v.z; });
    return out;
}

/// Finds the triangles of the other surface that may be within reach of a triangle. A missed one
/// makes a bound larger, never wrong.
void find_candidates(const TreeData& tree, std::span<const Triangle> other, const Corners& about,
                     double reach_mm, std::vector<std::uint32_t>& nodes,
                     std::vector<Corners>& out) {
    const Range range = range_of(about);
    out.clear();
    nodes.assign(1, 0);
    while (!nodes.empty()) {
        const TreeNode& node = tree.nodes[nodes.back()];
        nodes.pop_back();
        for (std::uint32_t i = 0; i < node.count; ++i) {
            bool is_near = true;
            for (int k = 0; k < 3; ++k) {
                is_near &= std::fabs(range.c[k] - double(node.c[k][i])) <=
                           range.h[k] + double(node.h[k][i]) + reach_mm;
            }
            if (is_near && node.leaf == kNoLeaf) {
                nodes.push_back(node.first_child + i);
            } else if (is_near) {
                out.push_back(corners_of(other[tree.leaves[node.leaf].triangle[i]]));
            }
        }
    }
}

/// The two halves of a piece, cut through its longest edge.
std::array<Piece, 2> halves_of(const Piece& piece) noexcept {
    const Corners& t = piece.corners;
    std::size_t from = 0;
    double longest = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double edge = length(t[(i + 1) % 3] - t[i]);
        if (edge > longest) {
            longest = edge;
            from = i;
        }
    }
    const Vec3d a = t[from], b = t[(from + 1) % 3], c = t[(from + 2) % 3];
    const Vec3d middle = between(a, b, 0.5);
    return {{{{a, middle, c}, piece.cuts + 1}, {{middle, b, c}, piece.cuts + 1}}};
}

enum class Cover : std::uint8_t { within, beyond, cut };

/// The distance from a convex set is convex: over a triangle it is largest at a corner.
Cover judge(const Piece& piece, std::span<const Corners> candidates, double within_mm) noexcept {
    std::array<bool, 3> is_near{};
    for (const Corners& candidate : candidates) {
        bool all = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const bool is_within = distance_up(piece.corners[i], candidate) <= within_mm;
            is_near[i] |= is_within;
            all &= is_within;
        }
        if (all) {
            return Cover::within;
        }
    }
    return is_near[0] && is_near[1] && is_near[2] ? Cover::cut : Cover::beyond;
}

bool is_near(const Corners& t, const Range& range, double reach_mm) noexcept {
    const Range other = range_of(t);
    bool near = true;
    for (int k = 0; k < 3; ++k) {
        near &= std::fabs(range.c[k] - other.c[k]) <= range.h[k] + other.h[k] + reach_mm;
    }
    return near;
}

/// Working memory for one triangle. Each piece appends its candidates (those of its parent that
/// are near it) to those of its parent.
struct Work {
    std::vector<Corners> candidates;
    std::size_t cuts = 0;
};

bool is_within(const Piece& piece, std::size_t first, double within_mm, Work& work) {
    const std::size_t end = work.candidates.size();
    const Cover cover =
        judge(piece, std::span(work.candidates).subspan(first, end - first), within_mm);
    if (cover != Cover::cut) {
        return cover == Cover::within;
    }
    if (piece.cuts == kCutsMax || ++work.cuts == kAllCutsMax) {
        return false;
    }
    for (const Piece& half : halves_of(piece)) {
        const Range range = range_of(half.corners);
        for (std::size_t i = first; i < end; ++i) {
            if (is_near(work.candidates[i], range, within_mm)) {
                work.candidates.push_back(Corners(work.candidates[i]));
            }
        }
        if (!is_within(half, end, within_mm, work)) {
            return false;
        }
        work.candidates.resize(end);
    }
    return true;
}

/// The first triangles of the surface, at most `most`, that are not proven to be within.
std::vector<std::uint32_t> find_beyond(std::span<const Triangle> surface,
                                       std::span<const Triangle> other, const TreeData& tree,
                                       double within_mm, std::size_t most) {
    std::vector<std::uint32_t> nodes, out;
    Work work;
    for (std::uint32_t i = 0; i < surface.size() && out.size() < most; ++i) {
        const Piece whole{corners_of(surface[i]), 0};
        work.cuts = 0;
        find_candidates(tree, other, whole.corners, within_mm, nodes, work.candidates);
        if (!is_within(whole, 0, within_mm, work)) {
            out.push_back(i);
        }
    }
    return out;
}

}  // namespace

std::vector<std::uint32_t> triangles_beyond(std::span<const Triangle> surface,
                                            std::span<const Triangle> other, double within_mm) {
    return find_beyond(surface, other, build_tree(other), within_mm, surface.size());
}

std::optional<double> bound_deviation(std::span<const Triangle> surface,
                                      std::span<const Triangle> other, double most_mm) {
    const TreeData tree = build_tree(other);
    const auto is_proven = [&](double within_mm) {
        return find_beyond(surface, other, tree, within_mm, 1).empty();
    };
    if (!is_proven(most_mm)) {
        return std::nullopt;
    }
    double low = 0, high = most_mm;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (is_proven(middle) ? high : low) = middle;
    }
    return high;
}

}  // namespace axg
