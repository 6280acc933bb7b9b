// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/exact_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/collision/closest_direction.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"

namespace axg::chart {
namespace {

// Distances computed in double are within nanometres of the truth: a pair whose distance exceeds
// the least by more than this is not the nearest.
constexpr double kDoubtMm = 1e-3;

struct Placed {
    Vec3d v[3], low, high;
};

Placed placed(const Vec3d (&v)[3]) {
    Placed out{{v[0], v[1], v[2]}, v[0], v[0]};
    for (const Vec3d& p : v) {
        out.low = {std::min(out.low.x, p.x), std::min(out.low.y, p.y), std::min(out.low.z, p.z)};
        out.high = {std::max(out.high.x, p.x), std::max(out.high.y, p.y),
                    std::max(out.high.z, p.z)};
    }
    return out;
}

double box_gap(const Placed& a, const Placed& b) {
    return std::max({a.low.x - b.high.x, b.low.x - a.high.x, a.low.y - b.high.y, b.low.y - a.high.y,
                     a.low.z - b.high.z, b.low.z - a.high.z});
}

/// The distance computed in double; 0 if the placed, rounded triangles share a point.
double about_mm(const Placed& a, const Placed& b) {
    lab::Pair<double> pair;
    sat::TrianglePair<double> p;
    for (int i = 0; i < 3; ++i) {
        pair.a[i] = a.v[i];
        pair.b[i] = b.v[i];
        const Vec3d la = a.v[i] - a.v[0], lb = b.v[i] - a.v[0];
        p.a[i] = {la.x, la.y, la.z};
        p.b[i] = {lb.x, lb.y, lb.z};
    }
    if (box_gap(a, b) <= 0 && lab::intersect(pair)) {
        return 0;
    }
    return std::sqrt(sat::closest_direction(p, sat::axes_of(p)).square);
}

struct Candidate {
    std::size_t a = 0, b = 0;
    double about_mm = 0;
};

}  // namespace

double exact_clearance_mm(const std::vector<Triangle>& a, const Pose& pose,
                          const std::vector<Triangle>& b, double within_mm) {
    std::vector<Placed> at_a, at_b;
    for (const Triangle& t : a) {
        at_a.push_back(
            placed({apply(pose, widen(t.a)), apply(pose, widen(t.b)), apply(pose, widen(t.c))}));
    }
    for (const Triangle& t : b) {
        at_b.push_back(placed({widen(t.a), widen(t.b), widen(t.c)}));
    }
    std::vector<Candidate> candidates;
    double nearest_mm = within_mm;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t j = 0; j < b.size(); ++j) {
            if (box_gap(at_a[i], at_b[j]) <= nearest_mm + kDoubtMm) {
                candidates.push_back({i, j, about_mm(at_a[i], at_b[j])});
                nearest_mm = std::min(nearest_mm, candidates.back().about_mm);
            }
        }
    }
    std::optional<mpq_class> least;
    for (const Candidate& c : candidates) {
        if (c.about_mm > nearest_mm + kDoubtMm) {
            continue;
        }
        const Triangle &ta = a[c.a], &tb = b[c.b];
        const lab::Pair<double> pair{{widen(ta.a), widen(ta.b), widen(ta.c)},
                                     {widen(tb.a), widen(tb.b), widen(tb.c)}};
        mpq_class square = lab::squared_distance(pair, pose);
        if (!least || square < *least) {
            least = std::move(square);
        }
    }
    return least ? lab::distance_mm(*least) : within_mm;
}

}  // namespace axg::chart
