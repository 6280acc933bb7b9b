// SPDX-License-Identifier: Apache-2.0
// The exact judge as a method of the laboratory. A gap between boxes larger than the error of the
// placed vertices decides most posed pairs; all other pairs are computed exactly.
#include "hil_replay/lab/methods/exact_method.hpp"

#include <algorithm>

#include "hil_replay/lab/judge/exact_judge.hpp"

namespace axg::lab {
namespace {

bool boxes_apart(const Pair<double>& p, double error_mm) noexcept {
    for (double Vec3d::*const k : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
        const auto [low_a, high_a] = std::minmax({p.a[0].*k, p.a[1].*k, p.a[2].*k});
        const auto [low_b, high_b] = std::minmax({p.b[0].*k, p.b[1].*k, p.b[2].*k});
        if (low_b - high_a > 2 * error_mm || low_a - high_b > 2 * error_mm) {
            return true;
        }
    }
    return false;
}

/// The judge applies the pose to its first triangle, so pass b first.
mpq_class squared_distance_of(const PairSet& pairs, std::size_t i) {
    const Pair<double>& given = pairs.given[i];
    if (pairs.poses.empty()) {
        return squared_distance(given);
    }
    return squared_distance(
        {{given.b[0], given.b[1], given.b[2]}, {given.a[0], given.a[1], given.a[2]}},
        pairs.poses[i]);
}

bool touches(const PairSet& pairs, std::size_t i) {
    if (pairs.poses.empty()) {
        return intersect(pairs.given[i]);
    }
    return !boxes_apart(pairs.f64[i], pairs.error_mm[i]) && squared_distance_of(pairs, i) == 0;
}

void judge_exactly(const PairSet& pairs, std::span<Verdict> verdicts,
                   std::span<double> distances_mm) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        verdicts[i] = Verdict::rejected;
        if (pairs.fitness[i] == Fitness::rejected) {
            continue;
        }
        if (!distances_mm.empty()) {
            distances_mm[i] = distance_mm(squared_distance_of(pairs, i));
        }
        verdicts[i] = touches(pairs, i) ? Verdict::intersecting : Verdict::separated;
    }
}

}  // namespace

void add_exact(std::vector<Method>& methods) {
    methods.push_back({.name = "exact",
                       .source = "signs and distances in GMP's whole numbers, behind a filter",
                       .scalar = Scalar::exact,
                       .certified = true,
                       .gives_distance = true,
                       .on_set = &judge_exactly});
}

}  // namespace axg::lab
