// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/separation.hpp"

namespace axg::certcheck {
namespace {

constexpr std::size_t kWalkMax = std::size_t{1} << 22;  // pairs of boxes

/// A direction n in the frames of both surfaces, and the lead that b has along it.
struct Sieve {
    Vector of_a, of_b;
    Interval between, needed;
};

/// The direction is not rounded: n is any vector near it, and is the same for both surfaces, so
/// nothing is assumed of the placements.
Sieve sieve_of(const PlacedSurface& a, const PlacedSurface& b, const Direction& direction,
               double r) {
    Vector n = turned(b.pose, {{direction[0], direction[1], direction[2]}});
    for (Interval& each : n.at) {
        each = (each.low + each.high) / 2;
    }
    return {turned_back(a.pose, n), turned_back(b.pose, n), dot(n, b.pose.shift - a.pose.shift),
            r * length(n)};
}

/// Where along e the triangles below a node can be.
Interval extent(const BoxTree& tree, TreeNode node, const Vector& e) {
    if (node.count > 1) {
        return dot(e, tree.box(node));
    }
    const Triangle& t = tree.triangle(node);
    const Interval a = dot(e, {{t[0], t[1], t[2]}}), b = dot(e, {{t[3], t[4], t[5]}}),
                   c = dot(e, {{t[6], t[7], t[8]}});
    return {min(min(a, b), c).low, max(max(a, b), c).high};
}

double size_of(const Vector& box) {
    return box[0].high - box[0].low + box[1].high - box[1].low + box[2].high - box[2].low;
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
        sieves.push_back(sieve_of(a, b, direction, r));
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
            const Sieve& sieve = sieves[tried];
            const Interval gap =
                extent(b.tree, of_b, sieve.of_b) - extent(a.tree, of_a, sieve.of_a) + sieve.between;
            // Positive, and above |n| r, which needs no squares.
            apart = gap.low > 0 && gap.low > sieve.needed.high;
            last = apart ? tried : last;
        }
        if (apart) {
            continue;
        }
        if (of_a.count == 1 && of_b.count == 1) {
            return "no direction separates two triangles by " + std::to_string(r) + " mm";
        }
        if (of_b.count == 1 ||
            (of_a.count > 1 && size_of(a.tree.box(of_a)) > size_of(b.tree.box(of_b)))) {
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
