// SPDX-License-Identifier: Apache-2.0
// ctest-labels: night
// The laboratory's methods in exact rationals: the same templates that are compiled for float and
// double, with nothing rounded and every threshold zero. What they get wrong in float is then
// rounding or their own rule, not our bug. The judge is a distance without any rounding. AXG_COUNT:
// pairs on the grid; a third as many are made by the kinds of contact.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <cstdio>
#include <random>
#include <vector>

#define AXG_LAB_UNIT in_rationals
#include "hil_replay/lab/methods/kernels.inl"
//
#include "tests/support/count.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Q = mpq_class;
using lab::Pair;
using lab::Verdict;
using Random = std::mt19937_64;

unsigned grid_count() {
    return test::exact_count(18000, 1500);
}

struct ExactCase {
    Pair<Q> pair;
    Q square;  // of the distance
    bool has_area, is_coplanar;
};

Vec3<Q> rational(const std::array<double, 3>& v) {
    return {Q(v[0]), Q(v[1]), Q(v[2])};
}

bool is_zero(const Vec3<Q>& v) {
    return v.x == 0 && v.y == 0 && v.z == 0;
}

ExactCase exact_case(const PlainTriangle<double>& a, const PlainTriangle<double>& b) {
    ExactCase out;
    for (std::size_t v = 0; v < 3; ++v) {
        out.pair.a[v] = rational(a[v]);
        out.pair.b[v] = rational(b[v]);
    }
    const ExactSquare truth = squared_distance(exact(a), exact(b));
    out.square = truth.above.value() / truth.below.value();
    const Pair<Q>& p = out.pair;
    const Vec3<Q> n = cross(p.a[1] - p.a[0], p.a[2] - p.a[0]);
    out.has_area = !is_zero(n) && !is_zero(cross(p.b[1] - p.b[0], p.b[2] - p.b[0]));
    out.is_coplanar = true;
    for (const Vec3<Q>& v : p.b) {
        out.is_coplanar = out.is_coplanar && dot(n, v - p.a[0]) == 0;
    }
    return out;
}

/// Whole coordinates of a few steps: touching, shared, parallel, coplanar and degenerate pairs
/// galore.
PlainTriangle<double> on_grid(Random& random, int steps, bool flat) {
    PlainTriangle<double> t;
    for (auto& v : t) {
        for (double& x : v) {
            x = static_cast<double>(random() % static_cast<unsigned>(2 * steps + 1)) - steps;
        }
        if (flat) {
            v[2] = 0;
        }
    }
    return t;
}

PlainTriangle<double> rounded(PlainTriangle<double> t) {
    for (auto& v : t) {
        for (double& x : v) {
            x = static_cast<double>(static_cast<float>(x));
        }
    }
    return t;
}

std::vector<ExactCase> made_cases() {
    Random random(printed_seed(20261121));
    std::vector<ExactCase> cases;
    for (unsigned i = 0; i < grid_count(); ++i) {
        const int steps = i % 2 == 0 ? 2 : 5;
        const bool flat = i % 3 == 0;
        cases.push_back(exact_case(on_grid(random, steps, flat), on_grid(random, steps, flat)));
    }
    for (unsigned i = 0; i < grid_count() / 3; ++i) {
        const CaseKind& kind = kCaseKinds[i % std::size(kCaseKinds)];
        const TriangleCase made = make_case(random, kind, -30);
        cases.push_back(exact_case(rounded(made.a), rounded(made.b)));
    }
    return cases;
}

const std::vector<ExactCase>& cases() {
    static const std::vector<ExactCase> kCases = made_cases();
    return kCases;
}

/// What a method's own description asks of its input.
struct Precondition {
    bool area = true;  // both triangles have some
    bool not_coplanar = false;
};

template <class Judge>
void is_right_in_exact_arithmetic(const char* name, Judge judge, Precondition wanted) {
    unsigned apart = 0, touching = 0;
    for (const ExactCase& c : cases()) {
        if ((wanted.area && !c.has_area) || (wanted.not_coplanar && c.is_coplanar)) {
            continue;
        }
        const bool is_apart = c.square > 0;
        (is_apart ? apart : touching) += 1;
        ASSERT_EQ(judge(c.pair), is_apart ? Verdict::separated : Verdict::intersecting)
            << name << ": a " << c.pair.a[0].x << ' ' << c.pair.a[0].y << ' ' << c.pair.a[0].z
            << ", " << c.pair.a[1].x << ' ' << c.pair.a[1].y << ' ' << c.pair.a[1].z << ", "
            << c.pair.a[2].x << ' ' << c.pair.a[2].y << ' ' << c.pair.a[2].z << "; b "
            << c.pair.b[0].x << ' ' << c.pair.b[0].y << ' ' << c.pair.b[0].z << ", "
            << c.pair.b[1].x << ' ' << c.pair.b[1].y << ' ' << c.pair.b[1].z << ", "
            << c.pair.b[2].x << ' ' << c.pair.b[2].y << ' ' << c.pair.b[2].z
            << (c.is_coplanar ? " (coplanar)" : "");
    }
    std::printf("%s: %u apart, %u touching\n", name, apart, touching);
    EXPECT_GT(apart, grid_count() / 10);
    EXPECT_GT(touching, grid_count() / 10);
}

template <class Judge>
void never_separates_what_touches(const char* name, Judge judge) {
    unsigned separated = 0;
    for (const ExactCase& c : cases()) {
        const bool told = judge(c.pair) == Verdict::separated;
        separated += told ? 1 : 0;
        ASSERT_FALSE(told && c.square == 0) << name;
    }
    EXPECT_GT(separated, grid_count() / 20) << name;
}

TEST(LabExact, SeventeenAxes) {
    is_right_in_exact_arithmetic("sat17", lab::in_rationals::sat17<Q>, {});
    never_separates_what_touches("sat17, without area too", lab::in_rationals::sat17<Q>);
}

TEST(LabExact, ElevenAxesOfTrianglesInTwoPlanes) {
    is_right_in_exact_arithmetic("sat11", lab::in_rationals::sat11<Q>, {.not_coplanar = true});
    never_separates_what_touches("sat11, without area too", lab::in_rationals::sat11<Q>);
}

TEST(LabExact, SixOrElevenAxes) {
    is_right_in_exact_arithmetic("paper-6-11", lab::in_rationals::paper_6_11<Q>, {});
}

TEST(LabExact, Moller) {
    is_right_in_exact_arithmetic("moller", lab::in_rationals::moller<Q>, {});
}

TEST(LabExact, Held) {
    is_right_in_exact_arithmetic("held", lab::in_rationals::held<Q>, {});
}

TEST(LabExact, GuigueDevillers) {
    is_right_in_exact_arithmetic("guigue-devillers", lab::in_rationals::guigue_devillers<Q>, {});
}

TEST(LabExact, Shen) {
    is_right_in_exact_arithmetic("shen", lab::in_rationals::shen<Q>, {});
}

TEST(LabExact, Tropp) {
    is_right_in_exact_arithmetic("tropp", lab::in_rationals::tropp<Q>, {});
}

TEST(LabExact, SixSegmentsOfTrianglesInTwoPlanes) {
    is_right_in_exact_arithmetic("six-segment", lab::in_rationals::six_segment<Q>,
                                 {.not_coplanar = true});
}

TEST(LabExact, PqpDistanceOfTrianglesWithArea) {
    unsigned judged = 0;
    for (const ExactCase& c : cases()) {
        if (c.has_area) {
            ++judged;
            ASSERT_EQ(lab::in_rationals::pqp_square(c.pair), c.square);
        }
    }
    EXPECT_GT(judged, grid_count() / 2);
}

TEST(LabExact, BoundingVolumesHoldTheirTriangles) {
    never_separates_what_touches("aabb", lab::in_rationals::aabb<Q>);
    never_separates_what_touches("18-dop", lab::in_rationals::dop18<Q>);
    never_separates_what_touches("obb", lab::in_rationals::obb<Q>);
}

}  // namespace
}  // namespace axg::test
#else
TEST(LabExact, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
