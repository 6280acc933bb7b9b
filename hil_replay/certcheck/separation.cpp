// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/separation.hpp"

namespace axg::certcheck {
namespace {

constexpr std::size_t kWalkMax = std::size_t{1} << 22;  // pairs of boxes

/// A direction in the frames of both surfaces, and what the walk's sums must exceed.
struct Sieve {
    std::array<double, 3> of_a, minus_of_b;
    double least;
};

/// The middle of an interval vector, and an upper bound of what sums along it are off, for corners
/// of this box: the width of the interval, and six roundings.
double middle_of(const Vector& vector, const BoxTree::Box& box, std::array<double, 3>& middle) {
    Interval off{0, 1e-300};
    for (std::size_t i = 0; i < 3; ++i) {
        middle[i] = (vector[i].low + vector[i].high) / 2;
        const Interval width = Interval(vector[i].high) - Interval(vector[i].low);
        const double largest = std::max(std::fabs(box.low[i]), std::fabs(box.high[i]));
        off = off + (width + std::fabs(middle[i]) * Interval(0x1p-50)) * largest;
    }
    return off.high;
}

/// @param direction not rounded: n is any vector near it, and is the same for both surfaces
Sieve prepared(const PlacedSurface& a, const PlacedSurface& b, const Direction& direction,
               double r) {
    const Vector around = turned(b.pose, {{direction[0], direction[1], direction[2]}});
    Vector n;
    for (std::size_t i = 0; i < 3; ++i) {
        n[i] = (around[i].low + around[i].high) / 2;
    }
    Sieve sieve;
    const double off_a = middle_of(turned_back(a.pose, n), a.tree.box(a.tree.top()), sieve.of_a);
    const double off_b =
        middle_of(-1 * turned_back(b.pose, n), b.tree.box(b.tree.top()), sieve.minus_of_b);
    const Interval between = dot(n, b.pose.shift - a.pose.shift);
    const Interval needed = length(n) * r;
    sieve.least = (needed - between + off_a + off_b).high;
    // A gap above 0 and above |n| r: needed is not below 0, and n = 0 separates nothing.
    if (!(length(n).low > 0)) {
        sieve.least = std::numeric_limits<double>::infinity();
    }
    return sieve;
}

double largest_along(const BoxTree& tree, TreeNode node, const std::array<double, 3>& e) {
    if (node.count > 1) {
        const BoxTree::Box& box = tree.box(node);
        return e[0] * (e[0] > 0 ? box.high[0] : box.low[0]) +
               e[1] * (e[1] > 0 ? box.high[1] : box.low[1]) +
               e[2] * (e[2] > 0 ? box.high[2] : box.low[2]);
    }
    const Triangle& t = tree.triangle(node);
    return std::max({e[0] * t[0] + e[1] * t[1] + e[2] * t[2],
                     e[0] * t[3] + e[1] * t[4] + e[2] * t[5],
                     e[0] * t[6] + e[1] * t[7] + e[2] * t[8]});
}

double size_of(const BoxTree& tree, TreeNode node) {
    const BoxTree::Box& box = tree.box(node);
    return box.high[0] - box.low[0] + box.high[1] - box.low[1] + box.high[2] - box.low[2];
}

}  // namespace

std::string not_separated(const PlacedSurface& a, const PlacedSurface& b,
                          const std::vector<Direction>& directions, double r) {
    struct Pair {
        TreeNode of_a, of_b;
    };
    std::vector<Pair> open{{a.tree.top(), b.tree.top()}};
    if (a.tree.triangles().empty() || b.tree.triangles().empty()) {
        return {};
    }
    std::vector<Sieve> sieves;
    for (const Direction& direction : directions) {
        sieves.push_back(prepared(a, b, direction, r));
    }
    std::size_t last = 0;  // the direction that separated the pair before is tried first
    for (std::size_t walked = 0; !open.empty(); ++walked) {
        if (walked == kWalkMax) {
            return "more than 4194304 pairs of boxes";
        }
        const auto [of_a, of_b] = open.back();
        open.pop_back();
        bool apart = false;
        for (std::size_t i = 0; i < sieves.size() && !apart; ++i) {
            const std::size_t tried = (last + i) % sieves.size();
            apart = below(below(-largest_along(b.tree, of_b, sieves[tried].minus_of_b)) -
                          largest_along(a.tree, of_a, sieves[tried].of_a)) > sieves[tried].least;
            last = apart ? tried : last;
        }
        if (apart) {
            continue;
        }
        if (of_a.count == 1 && of_b.count == 1) {
            return "no direction separates two triangles by " + std::to_string(r) + " mm";
        }
        if (of_b.count == 1 || (of_a.count > 1 && size_of(a.tree, of_a) > size_of(b.tree, of_b))) {
            open.push_back({of_a.lower(), of_b});
            open.push_back({of_a.upper(), of_b});
        } else {
            open.push_back({of_a, of_b.lower()});
            open.push_back({of_a, of_b.upper()});
        }
    }
    return {};
}

}  // namespace axg::certcheck
