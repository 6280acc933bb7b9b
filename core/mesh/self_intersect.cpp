// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/self_intersect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace axg {
namespace {

constexpr std::uint64_t kPairTestsBase =
    1U << 21;  // and 64 a facet: about a second at most for 16,000 facets
constexpr std::uint64_t kPairTestsPerFacet = 64;
constexpr std::uint64_t kNodeVisitsPerPairTest = 32;
constexpr std::uint32_t kFindingsMax = 1U << 16;
constexpr std::uint32_t kLeafFacets = 4;
constexpr std::uint32_t kStackMax = 64;  // a median split of 2^22 facets is 21 levels deep

using Corners = std::array<Vec3d, 3>;

struct Interval {
    double low, high;
};

Interval project(const Corners& t, Vec3d axis) noexcept {
    const double p = dot(axis, t[0]), q = dot(axis, t[1]), r = dot(axis, t[2]);
    return {std::fmin(p, std::fmin(q, r)), std::fmax(p, std::fmax(q, r))};
}

/// Whether both triangles overlap by more than the tolerance along the axis. A zero axis separates
/// nothing: true.
bool overlaps(const Corners& a, const Corners& b, Vec3d axis, double tolerance_mm) noexcept {
    const double length = std::sqrt(dot(axis, axis));
    const Interval p = project(a, axis), q = project(b, axis);
    const double depth = std::fmin(p.high - q.low, q.high - p.low);
    return length == 0 || depth > tolerance_mm * length;
}

/// Whether all corners are within the tolerance of the plane through `origin` with that normal.
bool lies_in(const Corners& t, Vec3d origin, Vec3d normal, double tolerance_mm) noexcept {
    const double limit = tolerance_mm * std::sqrt(dot(normal, normal));
    return std::all_of(t.begin(), t.end(),
                       [&](Vec3d p) { return std::fabs(dot(normal, p - origin)) <= limit; });
}

Corners edges_of(const Corners& t) noexcept {
    return {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
}

struct Aabb {
    Vec3f low{}, high{};
};

bool meet(const Aabb& a, const Aabb& b) noexcept {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y &&
           b.low.y <= a.high.y && a.low.z <= b.high.z && b.low.z <= a.high.z;
}

Vec3f min_of(Vec3f a, Vec3f b) noexcept {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3f max_of(Vec3f a, Vec3f b) noexcept {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
Aabb box_of(const Triangle& t) noexcept {
    return {min_of(t.a, min_of(t.b, t.c)), max_of(t.a, max_of(t.b, t.c))};
}

struct Node {
    Aabb box{};
    std::uint32_t first = 0, count = 0;  // facets in `order`
    std::uint32_t child = 0;  // index of the left child, the right one follows; 0: a leaf
};

/// Boxes over all facets, split at the median of the longest side: as deep as log2(n), whatever the
/// data.
class Tree {
  public:
    Tree(std::span<const Triangle> facets, std::span<const std::uint8_t> skip) {
        boxes_.resize(facets.size());
        for (std::uint32_t i = 0; i < facets.size(); ++i) {
            boxes_[i] = box_of(facets[i]);
            if (skip[i] == 0) {
                order_.push_back(i);
            }
        }
        nodes_.push_back({.count = static_cast<std::uint32_t>(order_.size())});
        for (std::uint32_t i = 0; i < nodes_.size();
             ++i) {  // nodes_ grows: breadth first, no recursion
            split(i);
        }
    }
    [[nodiscard]] const Node& node(std::uint32_t i) const { return nodes_[i]; }
    [[nodiscard]] const Aabb& box(std::uint32_t facet) const { return boxes_[facet]; }
    [[nodiscard]] std::span<const std::uint32_t> facets(const Node& n) const {
        return std::span(order_).subspan(n.first, n.count);
    }
    [[nodiscard]] std::span<const std::uint32_t> facets() const { return order_; }

  private:
    void split(std::uint32_t index) {
        Node n = nodes_[index];
        if (n.count == 0) {
            return;
        }
        const std::span<std::uint32_t> mine = std::span(order_).subspan(n.first, n.count);
        n.box = boxes_[mine[0]];
        for (const std::uint32_t facet : mine) {
            n.box.low = min_of(n.box.low, boxes_[facet].low);
            n.box.high = max_of(n.box.high, boxes_[facet].high);
        }
        if (n.count > kLeafFacets) {
            const Vec3f size = n.box.high - n.box.low;
            float Vec3f::*const side = size.x >= size.y && size.x >= size.z ? &Vec3f::x
                                       : size.y >= size.z                   ? &Vec3f::y
                                                                            : &Vec3f::z;
            const std::uint32_t half = n.count / 2;
            std::nth_element(mine.begin(), mine.begin() + half, mine.end(),
                             [&](std::uint32_t a, std::uint32_t b) {
                                 const float pa = boxes_[a].low.*side + boxes_[a].high.*side;
                                 const float pb = boxes_[b].low.*side + boxes_[b].high.*side;
                                 return pa != pb ? pa < pb : a < b;
                             });
            n.child = static_cast<std::uint32_t>(nodes_.size());
            nodes_.push_back({.first = n.first, .count = half});
            nodes_.push_back({.first = n.first + half, .count = n.count - half});
        }
        nodes_[index] = n;
    }

    std::vector<Aabb> boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

struct Search {
    std::span<const Triangle> facets;
    std::span<const std::uint32_t> shell;
    double tolerance_mm;
    std::uint64_t pair_tests_left, node_visits_left;
    SelfIntersections found;

    /// One pair, i < k; false when the search is over.
    bool test(std::uint32_t i, std::uint32_t k) noexcept {
        if (pair_tests_left == 0 || found.count == kFindingsMax) {
            found.complete = false;
            return false;
        }
        --pair_tests_left;
        const FacetContact contact = facet_contact(facets[i], facets[k], tolerance_mm);
        if (contact == FacetContact::none) {
            return true;
        }
        if (contact == FacetContact::opposed && shell[i] != shell[k]) {
            ++found.touching;
            return true;
        }
        if (found.count++ == 0) {
            found.first_a = i;
            found.first_b = k;
        }
        return true;
    }

    /// All partners of one facet with a higher index.
    bool run(const Tree& tree, std::uint32_t facet) noexcept {
        std::array<std::uint32_t, kStackMax> stack;
        std::uint32_t height = 0;
        stack[height++] = 0;
        while (height != 0) {
            const Node& node = tree.node(stack[--height]);
            if (node_visits_left == 0) {
                found.complete = false;
                return false;
            }
            --node_visits_left;
            if (!meet(node.box, tree.box(facet))) {
                continue;
            }
            if (node.child != 0) {
                stack[height++] = node.child;
                stack[height++] = node.child + 1;
                continue;
            }
            for (const std::uint32_t other : tree.facets(node)) {
                const bool is_due = other > facet && meet(tree.box(other), tree.box(facet));
                if (is_due && !test(facet, other)) {
                    return false;
                }
            }
        }
        return true;
    }
};

}  // namespace

FacetContact facet_contact(const Triangle& first, const Triangle& second,
                           double tolerance_mm) noexcept {
    const Vec3d origin = widen(first.a);  // differences of nearby floats are exact in double
    const Corners a{Vec3d{}, widen(first.b) - origin, widen(first.c) - origin};
    const Corners b{widen(second.a) - origin, widen(second.b) - origin, widen(second.c) - origin};
    const Corners edges_a = edges_of(a), edges_b = edges_of(b);
    const Vec3d normal_a = cross(edges_a[0], edges_a[1]);
    const Vec3d normal_b = cross(edges_b[0], edges_b[1]);
    const bool b_in_a = lies_in(b, a[0], normal_a, tolerance_mm);
    const bool a_in_b = lies_in(a, b[0], normal_b, tolerance_mm);
    if (b_in_a || a_in_b) {
        const Vec3d normal = b_in_a ? normal_a : normal_b;
        for (std::size_t i = 0; i < 3; ++i) {
            if (!overlaps(a, b, cross(normal, edges_a[i]), tolerance_mm) ||
                !overlaps(a, b, cross(normal, edges_b[i]), tolerance_mm)) {
                return FacetContact::none;
            }
        }
        return dot(normal_a, normal_b) > 0 ? FacetContact::same_way : FacetContact::opposed;
    }
    if (!overlaps(a, b, normal_a, tolerance_mm) || !overlaps(a, b, normal_b, tolerance_mm)) {
        return FacetContact::none;
    }
    for (const Vec3d& edge_a : edges_a) {
        for (const Vec3d& edge_b : edges_b) {
            if (!overlaps(a, b, cross(edge_a, edge_b), tolerance_mm)) {
                return FacetContact::none;
            }
        }
    }
    return FacetContact::crosses;
}

SelfIntersections find_self_intersections(std::span<const Triangle> facets,
                                          std::span<const std::uint32_t> shell,
                                          std::span<const std::uint8_t> skip, double tolerance_mm) {
    const Tree tree(facets, skip);
    const std::uint64_t pair_tests = kPairTestsBase + kPairTestsPerFacet * facets.size();
    Search search{.facets = facets,
                  .shell = shell,
                  .tolerance_mm = tolerance_mm,
                  .pair_tests_left = pair_tests,
                  .node_visits_left = kNodeVisitsPerPairTest * pair_tests,
                  .found = {}};
    for (const std::uint32_t facet : tree.facets()) {
        if (!search.run(tree, facet)) {
            break;
        }
    }
    return search.found;
}

}  // namespace axg
