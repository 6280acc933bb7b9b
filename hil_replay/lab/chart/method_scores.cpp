// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/chart/method_scores.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"

namespace axg::chart {
namespace {

using Wide = long double;  // the depth of a touch is near 0 and needs every digit
using WidePoint = Vec3<Wide>;

constexpr double kUmPerMm = 1e3;

/// Overlap of the projections along an axis, per unit of its length; the maximum for a zero axis.
Wide overlap_along(const WidePoint& axis, const WidePoint (&a)[3], const WidePoint (&b)[3]) {
    const Wide length = std::sqrt(dot(axis, axis));
    if (!(length > 0)) {
        return std::numeric_limits<Wide>::max();
    }
    Wide low_a = dot(axis, a[0]), high_a = low_a, low_b = dot(axis, b[0]), high_b = low_b;
    for (int i = 1; i < 3; ++i) {
        const Wide pa = dot(axis, a[i]), pb = dot(axis, b[i]);
        low_a = std::min(low_a, pa), high_a = std::max(high_a, pa);
        low_b = std::min(low_b, pb), high_b = std::max(high_b, pb);
    }
    return std::min(high_a - low_b, high_b - low_a) / length;
}

/// Smallest overlap over the seventeen axes: the shortest move along one of them that separates
/// the triangles. 0 if all axes are zero: points, segments on one line.
double depth_um(const lab::Pair<double>& pair) {
    WidePoint a[3], b[3], ea[3], eb[3];
    const auto local = [&pair](const Vec3d& v) {
        const Vec3d& o = pair.a[0];
        return WidePoint{Wide{v.x} - o.x, Wide{v.y} - o.y, Wide{v.z} - o.z};
    };
    for (int i = 0; i < 3; ++i) {
        a[i] = local(pair.a[i]);
        b[i] = local(pair.b[i]);
    }
    for (int i = 0; i < 3; ++i) {
        ea[i] = a[(i + 1) % 3] - a[i];
        eb[i] = b[(i + 1) % 3] - b[i];
    }
    const WidePoint na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
    Wide least = std::min(overlap_along(na, a, b), overlap_along(nb, a, b));
    for (int i = 0; i < 3; ++i) {
        least = std::min(
            {least, overlap_along(cross(ea[i], na), a, b), overlap_along(cross(eb[i], nb), a, b)});
        for (int j = 0; j < 3; ++j) {
            least = std::min(least, overlap_along(cross(ea[i], eb[j]), a, b));
        }
    }
    const bool has_axis = least < std::numeric_limits<Wide>::max();
    return has_axis ? kUmPerMm * static_cast<double>(std::max(least, Wide{0})) : 0;
}

template <class T>
Cases make_cases(std::uint64_t seed, std::size_t per_category) {
    Cases out;
    const std::size_t categories = lab::pair_category_count();
    out.pairs.reserve(categories * per_category);
    for (std::size_t category = 0; category < categories; ++category) {
        for (std::size_t i = 0; i < per_category; ++i) {
            out.pairs.add(lab::make_pair_case<T>(category, seed, i));
            out.category.push_back(category);
            out.truth.push_back(truth_of(out.pairs.given.back()));
            out.machine_like.push_back(is_machine_like(out.pairs.given.back()));
        }
    }
    return out;
}

void add_to(Score& score, lab::Verdict verdict, const Truth& truth) {
    using lab::Verdict;
    const bool undecided = verdict == Verdict::undecided;
    const bool far = truth.distance_um > 1;
    ++(truth.intersects ? score.intersecting : score.apart);
    if (truth.intersects) {
        score.undecided_hits += undecided ? 1 : 0;
        if (verdict == Verdict::separated) {
            ++score.missed;
            score.deepest_missed_um = std::max(score.deepest_missed_um, truth.depth_um);
        }
        return;
    }
    score.far += far ? 1 : 0;
    if (undecided) {
        ++score.undecided_apart;
        score.far_undecided += far ? 1 : 0;
        score.widest_undecided_um = std::max(score.widest_undecided_um, truth.distance_um);
    } else if (verdict == Verdict::intersecting) {
        ++score.false_hits;
        score.far_false_hits += far ? 1 : 0;
        score.farthest_false_hit_um = std::max(score.farthest_false_hit_um, truth.distance_um);
    }
}

/// The machine-like pairs that touch, or those that do not.
lab::PairSet chosen(const Cases& cases, bool touching) {
    lab::PairSet out;
    for (std::size_t i = 0; i < cases.truth.size(); ++i) {
        if (cases.machine_like[i] && cases.truth[i].intersects == touching) {
            out.add(cases.pairs.given[i]);
        }
    }
    return out;
}

double ns_a_pair(const lab::Method& method, const lab::PairSet& pairs,
                 std::vector<lab::Verdict>& verdicts) {
    using Clock = std::chrono::steady_clock;
    verdicts.resize(pairs.size());
    const Clock::time_point start = Clock::now();
    lab::run_method(method, pairs, verdicts, {});
    const std::chrono::duration<double, std::nano> spent = Clock::now() - start;
    return spent.count() / static_cast<double>(std::max<std::size_t>(pairs.size(), 1));
}

}  // namespace

Truth truth_of(const lab::Pair<double>& pair) {
    Truth truth{.intersects = lab::intersect(pair)};
    if (truth.intersects) {
        truth.depth_um = depth_um(pair);
    } else {
        truth.distance_um = kUmPerMm * lab::distance_mm(lab::squared_distance(pair));
    }
    return truth;
}

bool is_machine_like(const lab::Pair<double>& pair) {
    constexpr double kReachMm = 4000, kShortestMm = 1e-3;
    double most = 0, longest_a = 0, longest_b = 0;
    for (int i = 0; i < 3; ++i) {
        for (const Vec3d& v : {pair.a[i], pair.b[i]}) {
            most = std::max({most, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
        }
        const Vec3d ea = pair.a[(i + 1) % 3] - pair.a[i], eb = pair.b[(i + 1) % 3] - pair.b[i];
        longest_a = std::max(longest_a, dot(ea, ea));
        longest_b = std::max(longest_b, dot(eb, eb));
    }
    return most <= kReachMm && std::min(longest_a, longest_b) > kShortestMm * kShortestMm;
}

CaseBook make_case_book(std::uint64_t seed, std::size_t per_category) {
    return {.f32 = make_cases<float>(seed, per_category),
            .f64 = make_cases<double>(seed, per_category),
            .per_category = per_category};
}

MethodScore score_of(const lab::Method& method, const CaseBook& book) {
    const Cases& cases = book.of(method);
    MethodScore out;
    out.name = method.name;
    out.is_certified = method.certified;
    out.is_fused = method.fused;
    out.by_category.resize(lab::pair_category_count());
    const lab::Judged judged = lab::judge(method, cases.pairs, false);
    for (std::size_t i = 0; i < cases.truth.size(); ++i) {
        const Truth& truth = cases.truth[i];
        const lab::Verdict verdict = judged.verdicts[i];
        add_to(out.by_category[cases.category[i]], verdict, truth);
        if (!cases.machine_like[i]) {
            continue;
        }
        const bool is_deeper = truth.depth_um > out.machine.deepest_missed_um;
        const bool is_farther = truth.distance_um > out.machine.farthest_false_hit_um;
        add_to(out.machine, verdict, truth);
        if (truth.intersects && verdict == lab::Verdict::separated) {
            out.first_missed = std::min(out.first_missed, i);
            out.deepest_missed =
                is_deeper || out.deepest_missed == kNoCase ? i : out.deepest_missed;
        }
        if (!truth.intersects && verdict == lab::Verdict::intersecting) {
            out.first_false_hit = std::min(out.first_false_hit, i);
            out.farthest_false_hit =
                is_farther || out.farthest_false_hit == kNoCase ? i : out.farthest_false_hit;
        }
    }
    return out;
}

void time_methods(const CaseBook& book, const std::vector<const lab::Method*>& methods,
                  unsigned passes, std::vector<MethodScore>& scores) {
    struct Halves {
        lab::PairSet touching, apart;
    };
    const Halves f32{chosen(book.f32, true), chosen(book.f32, false)};
    const Halves f64{chosen(book.f64, true), chosen(book.f64, false)};
    std::vector<lab::Verdict> verdicts;
    for (unsigned pass = 0; pass < passes; ++pass) {
        for (std::size_t i = 0; i < methods.size(); ++i) {
            const Halves& halves = methods[i]->scalar == lab::Scalar::f64 ? f64 : f32;
            const double touching = ns_a_pair(*methods[i], halves.touching, verdicts);
            const double apart = ns_a_pair(*methods[i], halves.apart, verdicts);
            MethodScore& score = scores[i];
            score.ns_touching = pass == 0 ? touching : std::min(score.ns_touching, touching);
            score.ns_apart = pass == 0 ? apart : std::min(score.ns_apart, apart);
        }
    }
}

}  // namespace axg::chart
