// SPDX-License-Identifier: Apache-2.0
// Every method of the laboratory on pairs that no rounding makes hard, what it must refuse, and the
// tiles of the certified test: the same results in every set of lanes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>

#include "core/collision/closest_direction.hpp"
#include "core/collision/cpu_engine.hpp"
#include "core/collision/double_test.hpp"
#include "core/collision/shared_axes.hpp"
#include "core/collision/tri_sat.hpp"
#include "hil_replay/lab/methods/method.hpp"
#include "hil_replay/lab/methods/throughput.hpp"
#include "tests/support/seed.hpp"

namespace axg::lab {
namespace {

struct Clear {
    const char* what;
    Pair<float> pair;
    Verdict truth;
};

constexpr Clear kClear[] = {
    {"far above",
     {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 9}, {4, 2, 9}, {2, 4, 8}}},
     Verdict::separated},
    {"far beside",
     {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{30, 1, -2}, {34, 2, 3}, {32, 4, 1}}},
     Verdict::separated},
    {"pierces the face",
     {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{2, 2, -3}, {3, 2, 5}, {2, 3, 4}}},
     Verdict::intersecting},
    {"is pierced",
     {{{2, 2, -3}, {3, 2, 5}, {2, 3, 4}}, {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}},
     Verdict::intersecting},
    {"each pierces the other",
     {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{1, 1, -4}, {9, 9, -4}, {3, 3, 9}}},
     Verdict::intersecting},
};

/// What may be said of a clear pair instead of the truth.
Verdict weaker_verdict(const Method& method, Verdict truth) {
    if (has_domain(method) && truth == Verdict::intersecting) {
        return Verdict::undecided;
    }
    return method.bounding_volume ? Verdict::intersecting : truth;
}

TEST(LabMethods, JudgeClearPairsRightly) {
    PairSet pairs;
    for (const Clear& clear : kClear) {
        pairs.add(clear.pair);
    }
    for (const Method& method : methods()) {
        const Judged judged = judge(method, pairs, method.gives_distance);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            EXPECT_TRUE(judged.verdicts[i] == kClear[i].truth ||
                        judged.verdicts[i] == weaker_verdict(method, kClear[i].truth))
                << method.name << ": " << kClear[i].what;
            const bool is_far = kClear[i].what == std::string_view("far beside");
            EXPECT_TRUE(!is_far || judged.verdicts[i] == Verdict::separated) << method.name;
            if (!judged.distances_mm.empty()) {
                EXPECT_EQ(judged.distances_mm[i] > 1, kClear[i].truth == Verdict::separated)
                    << method.name << ": " << kClear[i].what;
            }
        }
    }
}

TEST(LabMethods, HaveNamesOfTheirOwnAndSources) {
    std::set<std::string_view> names;
    for (const Method& method : methods()) {
        EXPECT_TRUE(names.insert(method.name).second) << method.name;
        EXPECT_FALSE(method.source.empty()) << method.name;
        EXPECT_EQ(find_method(method.name), &method);
        EXPECT_EQ(
            (method.on_f32 != nullptr) + (method.on_f64 != nullptr) + (method.on_set != nullptr), 1)
            << method.name;
    }
    EXPECT_EQ(find_method("no such method"), nullptr);
}

TEST(LabMethods, RejectWhatIsNoNumberAndProveNothingBeyondTheDomain) {
    const auto with = [](double x) {
        return Pair<double>{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 9}, {4, 2, 9}, {x, 4, 8}}};
    };
    const double infinity = std::numeric_limits<double>::infinity();
    Pose lost;
    lost.t[1] = std::nan("");
    PairSet pairs, posed;
    pairs.add(with(std::nan("")));
    pairs.add(with(-infinity));
    pairs.add(with(std::nextafter(kLabDomainMm, infinity)));
    pairs.add(with(kLabDomainMm));
    posed.add(with(1), lost);
    for (const Method& method : methods()) {
        const std::vector<Verdict> verdicts = judge(method, pairs, false).verdicts;
        EXPECT_EQ(verdicts[0], Verdict::rejected) << method.name;
        EXPECT_EQ(verdicts[1], Verdict::rejected) << method.name;
        if (has_domain(method)) {
            EXPECT_EQ(verdicts[2], Verdict::undecided) << method.name;
            EXPECT_EQ(verdicts[3], Verdict::separated) << method.name;
        }
        EXPECT_EQ(judge(method, posed, false).verdicts[0], Verdict::rejected) << method.name;
    }
}

TEST(LabMethods, PlaceTheSecondTriangleByItsPose) {
    Pose pose;  // a quarter turn about z, then 7 up
    pose.r[0][0] = pose.r[1][1] = 0;
    pose.r[0][1] = -1;
    pose.r[1][0] = 1;
    const Pair<double> pair{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}},
                            {{2, -2, -3}, {2, -3, 5}, {3, -2, 4}}};
    PairSet pairs;
    pairs.add(pair, pose);
    pose.t[2] = 7;
    pairs.add(pair, pose);
    EXPECT_EQ(pairs.f64[0].b[0], (Vec3d{2, 2, -3}));
    EXPECT_GT(pairs.error_mm[0], 0);
    for (const Method& method : methods()) {
        const std::vector<Verdict> verdicts = judge(method, pairs, false).verdicts;
        EXPECT_NE(verdicts[0], Verdict::separated) << method.name;
        EXPECT_TRUE(verdicts[1] == Verdict::separated || method.bounding_volume) << method.name;
    }
}

/// One pair of a tile, one lane wide.
sat::TrianglePair<float> pair_of(const PairTile& tile, unsigned at) {
    sat::TrianglePair<float> p;
    float most[3] = {0, 0, 0};
    for (int v = 0; v < 3; ++v) {
        for (int k = 0; k < 3; ++k) {
            const float a = tile.v[3 * v + k][at], b = tile.v[9 + 3 * v + k][at];
            most[k] = std::max({most[k], std::fabs(a), std::fabs(b)});
        }
        p.a[v] = {tile.v[3 * v][at], tile.v[3 * v + 1][at], tile.v[3 * v + 2][at]};
        p.b[v] = {tile.v[9 + 3 * v][at], tile.v[10 + 3 * v][at], tile.v[11 + 3 * v][at]};
    }
    const float d = tile.d[at];
    p.scale = {sat::scale_of(most[0], d), sat::scale_of(most[1], d), sat::scale_of(most[2], d)};
    return p;
}

/// The same numbers in double.
sat::TrianglePair<double> in_double(const sat::TrianglePair<float>& p) {
    sat::TrianglePair<double> out;
    double most[3] = {0, 0, 0};
    for (int v = 0; v < 3; ++v) {
        for (const bool of_a : {true, false}) {
            const sat::V3<float>& from = of_a ? p.a[v] : p.b[v];
            (of_a ? out.a[v] : out.b[v]) = {from.x, from.y, from.z};
            most[0] = std::max(most[0], std::fabs(double(from.x)));
            most[1] = std::max(most[1], std::fabs(double(from.y)));
            most[2] = std::max(most[2], std::fabs(double(from.z)));
        }
    }
    out.scale = {sat::scale_of(most[0], 0.0), sat::scale_of(most[1], 0.0),
                 sat::scale_of(most[2], 0.0)};
    return out;
}

TEST(LabTiles, HaveTheBitsOfOneLaneInEveryLaneSet) {
    std::mt19937_64 random(test::printed_seed(20261121));
    std::uniform_real_distribution<float> place(-1, 1);
    PairSet pairs;
    for (int i = 0; i < 4000; ++i) {
        Pair<float> pair;
        const float away = 0.25F * static_cast<float>(i % 8);
        for (int v = 0; v < 3; ++v) {
            pair.a[v] = {place(random), place(random), place(random)};
            pair.b[v] = {place(random) + away, place(random), i % 5 == 0 ? 0.0F : place(random)};
        }
        pairs.add(pair);
    }
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        const LaneKernels* const lanes = lane_kernels(set);
        if (lanes == nullptr) {
            continue;
        }
        std::vector<TileResult> tested(pairs.tiles.size()), measured(pairs.tiles.size());
        std::vector<TileResult> shared(pairs.tiles.size());
        lanes->share_tiles(pairs.tiles.data(), pairs.tiles.size(), shared.data());
        lanes->test_tiles(pairs.tiles.data(), pairs.tiles.size(), tested.data());
        lanes->measure_tiles(pairs.tiles.data(), pairs.tiles.size(), measured.data());
        unsigned apart_count = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const unsigned at = i % kTilePairs;
            const sat::TrianglePair<float> p = pair_of(pairs.tiles[i / kTilePairs], at);
            const sat::V3<float> l = sat::closest_direction(p, sat::axes_of(p)).direction;
            const float d = pairs.tiles[i / kTilePairs].d[at];
            const bool by_shared = sat::separated_shared<false, false>(p.a, p.b, d, 0.0F);
            const bool apart =
                by_shared || sat::separated_17<false>(p, 0.0F) || sat::separates<false>(p, l, 0.0F);
            EXPECT_EQ(shared[i / kTilePairs].apart >> at & 1U, by_shared ? 1U : 0U) << i;
            apart_count += apart ? 1 : 0;
            EXPECT_EQ(tested[i / kTilePairs].apart >> at & 1U, apart ? 1U : 0U) << i;
            EXPECT_EQ(measured[i / kTilePairs].apart >> at & 1U, apart ? 1U : 0U) << i;
            const float proven = std::max(sat::certified_distance(p, l), 0.0F);
            EXPECT_EQ(measured[i / kTilePairs].distance_mm[at], proven) << i;
            const sat::TrianglePair<double> wide = in_double(p);
            const sat::V3<double> m = sat::closest_direction(wide, sat::axes_of(wide)).direction;
            EXPECT_EQ(lanes->apart_in_double(wide), sat::apart_in_double<false>(wide, 0.0)) << i;
            EXPECT_EQ(lanes->distance_in_double(wide),
                      std::max(sat::certified_distance(wide, m), 0.0))
                << i;
        }
        EXPECT_GT(apart_count, 1000U);
        EXPECT_LT(apart_count, 3900U);
    }
}

TEST(LabThroughput, TimesEveryMethodOnTheSamePairs) {
    const PairSet pairs = overlapping_pairs(64, 7), again = overlapping_pairs(64, 7);
    const PairSet other = overlapping_pairs(64, 8), hits = intersecting_pairs(64, 7);
    EXPECT_EQ(pairs.f32[63].b[2], again.f32[63].b[2]);
    EXPECT_NE(pairs.f32[63].b[2], other.f32[63].b[2]);
    std::vector<const Method*> all;
    for (const Method& method : methods()) {
        all.push_back(&method);
    }
    const Method& boxes = *find_method("aabb-f64");
    for (const Verdict verdict : judge(boxes, pairs, false).verdicts) {
        EXPECT_EQ(verdict, Verdict::intersecting);
    }
    for (const Verdict verdict : judge(*find_method("certified-f32"), hits, false).verdicts) {
        EXPECT_EQ(verdict, Verdict::undecided);
    }
    const std::vector<PairTime> times = time_methods(all, pairs, 3);
    ASSERT_EQ(times.size(), all.size());
    for (const PairTime& time : times) {
        EXPECT_GT(time.least_ns, 0);
        EXPECT_LE(time.least_ns, time.median_ns);
    }
}

}  // namespace
}  // namespace axg::lab
