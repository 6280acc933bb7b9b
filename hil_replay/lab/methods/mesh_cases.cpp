// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/methods/mesh_cases.hpp"

#include <algorithm>
#include <limits>

namespace axg::lab {
namespace {

/// Result over the pairs judged up to now.
struct Least {
    Verdict verdict = Verdict::separated;
    double distance_mm = std::numeric_limits<double>::infinity();
};

/// False for exact methods: exact distances of millions of pairs need hours.
bool measures(const Method& method) noexcept {
    return method.gives_distance && method.scalar != Scalar::exact;
}

unsigned weight_of(Verdict verdict) noexcept {
    switch (verdict) {
        case Verdict::separated:
            return 0;
        case Verdict::undecided:
            return 1;
        case Verdict::intersecting:
            return 2;
        case Verdict::rejected:
            break;
    }
    return 3;
}

void lower(Least& least, const Judged& judged) noexcept {
    for (const Verdict verdict : judged.verdicts) {
        if (weight_of(verdict) > weight_of(least.verdict)) {
            least.verdict = verdict;
        }
    }
    for (const double d : judged.distances_mm) {
        least.distance_mm = std::min(least.distance_mm, d);
    }
}

Least judge_one(const Method& method, const Mesh& a, const Mesh& b, const Pose& pose) {
    constexpr std::size_t kPairsAtOnce = 4096;
    Least least;
    PairSet pairs;
    for (const Triangle& ta : a.triangles) {
        for (const Triangle& tb : b.triangles) {
            pairs.add(
                {{widen(ta.a), widen(ta.b), widen(ta.c)}, {widen(tb.a), widen(tb.b), widen(tb.c)}},
                pose);
        }
        if (pairs.size() >= kPairsAtOnce || &ta == &a.triangles.back()) {
            lower(least, judge(method, pairs, measures(method)));
            pairs = {};
        }
    }
    return least;
}

}  // namespace

Judged judge_meshes(const Method& method, std::span<const Mesh> meshes,
                    std::span<const MeshCase> cases) {
    Judged out;
    for (const MeshCase& at : cases) {
        const Least least = judge_one(method, meshes[at.a], meshes[at.b], at.pose);
        out.verdicts.push_back(least.verdict);
        if (measures(method)) {
            out.distances_mm.push_back(least.distance_mm);
        }
    }
    return out;
}

}  // namespace axg::lab
