// SPDX-License-Identifier: Apache-2.0
// What is certified within the margin is near in exact arithmetic, for every kind of contact and
// margins on both sides of the distance; no pair is certified within it and apart; and the claim is
// made for nearly every pair that is well within the margin. The number of pairs a kind: AXG_COUNT.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cstdio>

#include "core/collision/certified_within.hpp"
#include "core/collision/pair_test.hpp"
#include "tests/support/count.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

constexpr float kErrorLeast = 0x1p-90F;  // d of exact vertices

/// A pair as the kernels have it: less an origin, in float. The vertices are taken as exact there.
struct LocalPair {
    sat::V3<float> a[3], b[3];
    PlainTriangle<float> plain_a, plain_b;

    explicit LocalPair(const TriangleCase& made) {
        const std::array<double, 3> origin = made.a[0];
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                plain_a[i][k] = static_cast<float>(made.a[i][k] - origin[k]);
                plain_b[i][k] = static_cast<float>(made.b[i][k] - origin[k]);
            }
            a[i] = {plain_a[i][0], plain_a[i][1], plain_a[i][2]};
            b[i] = {plain_b[i][0], plain_b[i][1], plain_b[i][2]};
        }
    }
    [[nodiscard]] bool is_near(double r_mm) const {
        const sat::TrianglePair<float> p = sat::scaled_pair(a, b, kErrorLeast);
        float edges_square = 0;
        static_cast<void>(sat::closest_direction(p, sat::axes_of(p), &edges_square));
        return sat::certified_within(p, edges_square, sat::near_limit(r_mm));
    }
    [[nodiscard]] bool is_apart(double r_mm) const {
        const auto margin = static_cast<float>(r_mm * (1.0 + 0x1p-19));
        const auto square = static_cast<float>(r_mm * r_mm * (1.0 + 0x1p-16));
        return sat::apart<true>(a, b, {kErrorLeast, margin, square});
    }
    [[nodiscard]] ExactSquare distance() const {
        return squared_distance(exact(plain_a), exact(plain_b));
    }
};

struct WithinTally {
    unsigned pairs = 0, claims = 0, well_within = 0, claimed_of_those = 0;
};

/// A margin around `distance_mm`: equal, a little or a lot more or less.
double some_margin(std::mt19937_64& random, double distance_mm) {
    constexpr double kOff[] = {0, 0x1p-22, 0x1p-19, 0x1p-16, 0x1p-10, 0.25};
    const double off = kOff[random() % 6] * ((random() & 1U) == 0 ? 1 : -1);
    return std::max(distance_mm * (1 + off), (random() & 1U) == 0 ? 0x1p-40 : 1e-3);
}

void judge_within(std::mt19937_64& random, const CaseKind& kind, WithinTally& tally) {
    const LocalPair pair(make_case(random, kind, -20));
    const ExactSquare square = pair.distance();
    const double distance_mm = square.mm(), r_mm = some_margin(random, distance_mm);
    const bool is_near = pair.is_near(r_mm);
    ASSERT_FALSE(is_near && square.more_than(r_mm))
        << kind.name << ": distance " << distance_mm << " mm, margin " << r_mm;
    ASSERT_FALSE(is_near && pair.is_apart(r_mm)) << kind.name;
    ++tally.pairs;
    tally.claims += is_near ? 1 : 0;
    const double wide_mm = distance_mm * 1.5 + 0.5 * kind.scale_mm;
    ++tally.well_within;
    tally.claimed_of_those += pair.is_near(wide_mm) ? 1 : 0;
}

TEST(CertifiedWithin, IsNeverSaidOfPairsThatAreApart) {
    std::mt19937_64 random(printed_seed(71));
    const unsigned count = count_a_kind();
    WithinTally all;
    for (const CaseKind& kind : kCaseKinds) {
        if (kind.scale_mm > 1e4) {
            continue;  // beyond what the engines take, less an origin nearby
        }
        WithinTally tally;
        for (unsigned i = 0; i < count && !HasFatalFailure(); ++i) {
            judge_within(random, kind, tally);
        }
        std::printf("%-38s %6u pairs, %6u surely near; well within the margin %6u of %6u\n",
                    kind.name, tally.pairs, tally.claims, tally.claimed_of_those,
                    tally.well_within);
        all.pairs += tally.pairs;
        all.claims += tally.claims;
        all.well_within += tally.well_within;
        all.claimed_of_those += tally.claimed_of_those;
    }
    if (count < 50) {
        return;  // too few to tell how often the claim is made
    }
    EXPECT_GT(all.claims, all.pairs / 5);
    EXPECT_GT(all.claimed_of_those, all.well_within / 10 * 9) << "the claim is worth making";
}

}  // namespace
}  // namespace axg::test

#else
TEST(CertifiedWithin, IsNeverSaidOfPairsThatAreApart) {
    GTEST_SKIP() << "needs GMP; install libgmp-dev";
}
#endif
