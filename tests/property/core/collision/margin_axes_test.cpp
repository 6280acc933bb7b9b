// SPDX-License-Identifier: Apache-2.0
// With a margin, float tries the normals and the closest direction and leaves out the other fifteen
// axes. Counts what they would prove, by how far the triangles are beyond the margin. AXG_COUNT:
// pairs of triangles; the record is of 1e6.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/collision/double_test.hpp"
#include "core/collision/pair_test.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr float kErrorLeast = 0x1p-90F;
constexpr std::array kBands{0.1, 1.0, 4.0, 16.0, 64.0};
constexpr std::array kDistancesMm{0.01, 0.1, 1.0};  // between the classes of the record

template <class T>
struct Vertices {
    sat::V3<T> a[3], b[3];
};

template <class T>
Vertices<double> in_double(const Vertices<T>& v) {
    Vertices<double> out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = {double(v.a[i].x), double(v.a[i].y), double(v.a[i].z)};
        out.b[i] = {double(v.b[i].x), double(v.b[i].y), double(v.b[i].z)};
    }
    return out;
}

/// Certified, from below.
double distance_mm(const Vertices<float>& v) {
    const Vertices<double> wide = in_double(v);
    const sat::TrianglePair<double> p = sat::scaled_pair(wide.a, wide.b, 0x1p-800);
    return sat::certified_distance(p, sat::closest_direction(p, sat::axes_of(p)).direction);
}

/// Twice the bound of a vector of length 1: what float leaves undecided, as a rule.
double vertex_band_mm(const Vertices<float>& v) {
    float most = 0;
    for (const auto* side : {v.a, v.b}) {
        for (int i = 0; i < 3; ++i) {
            most = std::max(most, sat::largest(side[i]));
        }
    }
    return 18 * 0x1p-24 * std::sqrt(3.0) * double(most);
}

template <bool kTriesAxes>
bool is_apart(const Vertices<float>& v, double r_mm) {
    const double r = std::max(r_mm, 0x1p-40);
    return sat::apart<true, kTriesAxes>(
        v.a, v.b,
        {kErrorLeast, static_cast<float>(r * (1 + 0x1p-20) * (1 + 0x1p-22)),
         static_cast<float>(r * r * (1 + 0x1p-17))});
}

class MarginAxes : public testing::Test {
  protected:
    struct Tally {
        unsigned pairs = 0;
        std::array<unsigned, kBands.size()> lost{};
    };
    using Tallies = std::array<Tally, kDistancesMm.size() + 1>;

    /// Triangles of machine parts: 1 to 100 mm long, mostly less than 20 mm apart, every shape.
    Vertices<float> part() {
        Vertices<float> v;
        const double size = draw.between(1, 100);
        const double away = 20 / static_cast<double>(1U << draw.below(14));
        const double other = draw.below(4) == 0 ? 0.01 * size : size;
        for (int i = 0; i < 3; ++i) {
            v.a[i] = point(size, -draw.between(0, size));
            v.b[i] = point(other, away + draw.between(0, other));
        }
        // An edge of each near the plane between them.
        v.a[0].z = v.a[1].z = 0;
        v.b[0].z = v.b[1].z = static_cast<float>(away);
        return v;
    }
    sat::V3<float> point(double size, double z) {
        const double x = draw.between(-size, size), y = draw.between(-size, size);
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    }
    /// One of those made to break a test, moved near the origin.
    Vertices<float> hard(std::uint64_t index) const {
        const std::size_t category = index % lab::pair_category_count();
        const lab::Pair<float> pair = lab::make_pair_case<float>(category, seed, index);
        Vertices<float> v;
        for (int i = 0; i < 3; ++i) {
            const auto less = [&](const auto& p) -> sat::V3<float> {
                return {p.x - pair.a[0].x, p.y - pair.a[0].y, p.z - pair.a[0].z};
            };
            v.a[i] = less(pair.a[i]);
            v.b[i] = less(pair.b[i]);
        }
        return v;
    }
    static void judge(const Vertices<float>& v, Tallies& tallies) {
        const double distance = distance_mm(v), band = vertex_band_mm(v);
        if (!(distance > 0)) {
            return;
        }
        const auto at = std::upper_bound(kDistancesMm.begin(), kDistancesMm.end(), distance);
        Tally& tally = tallies.at(static_cast<std::size_t>(at - kDistancesMm.begin()));
        ++tally.pairs;
        for (std::size_t i = 0; i < kBands.size(); ++i) {
            const double r = distance - kBands[i] * band;
            if (r <= 0) {
                continue;
            }
            const bool without = is_apart<false>(v, r), with = is_apart<true>(v, r);
            EXPECT_FALSE(without && !with) << "more axes prove no less";
            tally.lost[i] += with && !without ? 1 : 0;
        }
    }
    static void print(const char* name, const Tallies& tallies) {
        std::printf("%s: pairs, lost at 0.1, 1, 4, 16, 64 bands; by distance\n", name);
        for (const Tally& tally : tallies) {
            std::printf("  %u:", tally.pairs);
            for (const unsigned lost : tally.lost) {
                std::printf(" %u", lost);
            }
            std::printf("\n");
        }
    }

    std::uint64_t seed = test::printed_seed(20261123);
    lab::Draw draw{seed};
};

TEST_F(MarginAxes, TheFifteenProveHardlyAnythingMore) {
    const std::uint64_t count = test::count_from_environment(6000);
    Tallies parts{}, hards{};
    for (std::uint64_t i = 0; i < count / 2; ++i) {
        judge(part(), parts);
        judge(hard(i), hards);
    }
    print("parts", parts);
    print("hard cases", hards);
    for (const Tally& tally : parts) {
        EXPECT_GT(tally.pairs, count / 100);
    }
    const Tally& clear = parts.back();  // 1 mm and more apart
    EXPECT_LE(clear.lost[2], clear.pairs / 250) << "at four bands";
    EXPECT_LE(clear.lost.back(), 1 + clear.pairs / 10000) << "at 64";
    EXPECT_GT(parts.front().lost.back(), 0U) << "next to contact the fifteen would help";
}

}  // namespace
}  // namespace axg
