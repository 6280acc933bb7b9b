// SPDX-License-Identifier: Apache-2.0
// The shared axes against exact arithmetic: the identities hold exactly, the roundings stay within
// their bounds, and what is claimed of a pair of triangles is true, for float and double, for every
// kind of contact. The number of pairs a kind: AXG_COUNT.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cstdio>
#include <vector>

#include "core/collision/lanes.hpp"
#include "tests/support/count.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {

/// A number without rounding, with the operators of a lane.
struct Exact {
    Dyadic v;

    Exact() = default;
    Exact(const Dyadic& d) : v(d) {}  // NOLINT(google-explicit-constructor)
    explicit Exact(double d) : v(Dyadic(d)) {}
    friend Exact operator+(const Exact& a, const Exact& b) { return a.v + b.v; }
    friend Exact operator-(const Exact& a, const Exact& b) { return a.v - b.v; }
    friend Exact operator*(const Exact& a, const Exact& b) { return a.v * b.v; }
    friend Exact operator-(const Exact& a) { return Dyadic(0.0) - a.v; }
};
inline bool less(const Exact& a, const Exact& b) {
    return (b - a).v.sign() > 0;
}

}  // namespace axg::test

namespace axg::lanes {
using test::Exact;
inline Exact min(const Exact& a, const Exact& b) {
    return test::less(a, b) ? a : b;
}
inline Exact max(const Exact& a, const Exact& b) {
    return test::less(b, a) ? a : b;
}
inline Exact abs(const Exact& a) {
    return a.v.sign() < 0 ? -a : a;
}
inline Exact fma(const Exact& a, const Exact& b, const Exact& c) {
    return a * b + c;
}
template <>
struct Traits<Exact> {
    static constexpr double kUnit = 0, kTiny = 0;
    static Exact of(double c) { return Exact(c); }
};
}  // namespace axg::lanes

#include "core/collision/shared_axes.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

template <class T>
sat::V3<T> vector_of(const std::array<T, 3>& v) {
    return {v[0], v[1], v[2]};
}

template <class T>
sat::V3<Exact> exactly(const sat::V3<T>& v) {
    return {Exact(double(v.x)), Exact(double(v.y)), Exact(double(v.z))};
}

template <class T>
sat::EdgePair<Exact> exactly(const sat::EdgePair<T>& p) {
    return {{exactly(p.e[0]), exactly(p.e[1])}, {exactly(p.f[0]), exactly(p.f[1])}, exactly(p.d)};
}

sat::V3<Exact> cross(const sat::V3<Exact>& a, const sat::V3<Exact>& b) {
    return sat::plain_cross(a, b);
}

sat::V3<Exact> plus(const sat::V3<Exact>& a, const sat::V3<Exact>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

/// Gap of the projections on l, from the six vertices themselves.
Exact projected_gap(const sat::EdgePair<Exact>& p, const sat::V3<Exact>& l) {
    const Exact zero(0.0);
    const Exact a[3] = {zero, sat::dot3(l, p.e[0]), sat::dot3(l, p.e[1])};
    const Exact d = sat::dot3(l, p.d);
    const Exact b[3] = {d, sat::dot3(l, plus(p.d, p.f[0])), sat::dot3(l, plus(p.d, p.f[1]))};
    using lanes::max, lanes::min;
    return max(min(min(b[0], b[1]), b[2]) - max(max(a[0], a[1]), a[2]),
               min(min(a[0], a[1]), a[2]) - max(max(b[0], b[1]), b[2]));
}

struct Axes {
    sat::V3<Exact> n, m, cross[3][3], in_plane_a[3], in_plane_b[3];
};

Axes axes_of(const sat::EdgePair<Exact>& p) {
    const sat::V3<Exact> x[3] = {p.e[0], p.e[1], sat::sub(p.e[1], p.e[0])};
    const sat::V3<Exact> y[3] = {p.f[0], p.f[1], sat::sub(p.f[1], p.f[0])};
    Axes axes;
    axes.n = cross(p.e[0], p.e[1]), axes.m = cross(p.f[0], p.f[1]);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            axes.cross[i][j] = cross(x[i], y[j]);
        }
        axes.in_plane_a[i] = cross(x[i], axes.n), axes.in_plane_b[i] = cross(y[i], axes.m);
    }
    return axes;
}

// The formulas with shared products are the projections on the seventeen axes: exactly. In-plane
// normals look outward only: there the gap is the projected one wherever it is positive on the
// outer side, and never more than the projected one.
TEST(SharedAxes, AreTheProjectionsInExactArithmetic) {
    Random random(printed_seed(20261130));
    unsigned outward = 0;
    for (const CaseKind& kind : kCaseKinds) {
        for (unsigned i = 0; i < std::max(5U, count_a_kind() / 20); ++i) {
            const TriangleCase made = make_case(random, kind, -30);
            sat::V3<double> a[3], b[3];
            for (std::size_t v = 0; v < 3; ++v) {
                a[v] = vector_of(made.a[v]), b[v] = vector_of(made.b[v]);
            }
            const sat::EdgePair<Exact> p = exactly(sat::edges_of(a, b));
            const sat::EdgeProducts<Exact> x = sat::products_of(p);
            const sat::SharedGaps<Exact> g = sat::gaps_of(p, sat::normal_products(p), x);
            const Axes axes = axes_of(p);
            const auto equal = [&kind](const Exact& u, const Exact& v, const char* what) {
                EXPECT_EQ((u - v).v.sign(), 0) << kind.name << ": " << what;
            };
            equal(g.normal_a, projected_gap(p, axes.n), "normal of a");
            equal(g.normal_b, projected_gap(p, axes.m), "normal of b");
            equal(x.area_a, sat::dot3(axes.n, axes.n), "square of the normal of a");
            equal(x.area_b, sat::dot3(axes.m, axes.m), "square of the normal of b");
            for (int k = 0; k < 9; ++k) {
                const Exact gap = projected_gap(p, axes.cross[k / 3][k % 3]);
                equal(g.twice_cross[k / 3][k % 3], gap + gap, "cross");
            }
            for (int k = 0; k < 3; ++k) {
                const Exact gap[2] = {projected_gap(p, axes.in_plane_a[k]),
                                      projected_gap(p, axes.in_plane_b[k])};
                const Exact shared[2] = {g.in_plane_a[k], g.in_plane_b[k]};
                for (int side = 0; side < 2; ++side) {
                    EXPECT_GE((gap[side] - shared[side]).v.sign(), 0) << kind.name;
                    if (shared[side].v.sign() > 0) {
                        equal(shared[side], gap[side], "in-plane");
                        ++outward;
                    }
                }
            }
        }
    }
    EXPECT_GT(outward, 100U) << "the in-plane axes never decided anything";
}

/// Worst share of each bound that the roundings of one kind of axis used up.
struct Worst {
    double normal = 0, cross = 0, in_plane = 0;

    [[nodiscard]] double most() const { return std::max({normal, cross, in_plane}); }
};

double share(float computed, const Exact& truth, float bound) {
    const Exact surplus = Exact(double(computed)) - truth;
    return surplus.v.value().get_d() / double(bound);
}

void keep_worst(Worst& worst, const sat::EdgePair<float>& p) {
    const sat::SharedBounds<float> s = sat::shared_bounds(p, sat::V3<float>{0, 0, 0}, 0.0F);
    const sat::SharedGaps<float> g = sat::gaps_of(p, sat::normal_products(p), sat::products_of(p));
    const sat::EdgePair<Exact> q = exactly(p);
    const sat::SharedGaps<Exact> t = sat::gaps_of(q, sat::normal_products(q), sat::products_of(q));
    worst.normal = std::max({worst.normal, share(g.normal_a, t.normal_a, s.normal_a),
                             share(g.normal_b, t.normal_b, s.normal_b)});
    for (int k = 0; k < 9; ++k) {
        worst.cross = std::max(worst.cross, share(g.twice_cross[k / 3][k % 3],
                                                  t.twice_cross[k / 3][k % 3], s.twice_cross));
    }
    for (int k = 0; k < 3; ++k) {
        worst.in_plane =
            std::max({worst.in_plane, share(g.in_plane_a[k], t.in_plane_a[k], s.in_plane_a),
                      share(g.in_plane_b[k], t.in_plane_b[k], s.in_plane_b)});
    }
}

float& coordinate(sat::EdgePair<float>& p, unsigned i) {
    sat::V3<float>* const v[5] = {&p.e[0], &p.e[1], &p.f[0], &p.f[1], &p.d};
    sat::V3<float>& x = *v[i / 3];
    return i % 3 == 0 ? x.x : i % 3 == 1 ? x.y : x.z;
}

// A search for roundings that all go one way: it comes near enough to the bounds to notice a
// constant that is several times too small, and never beyond them.
TEST(SharedAxes, RoundingsStayWithinTheirBounds) {
    Random random(printed_seed(20261131));
    Worst worst;
    for (unsigned round = 0; round < std::max(100U, count_a_kind() / 10); ++round) {
        sat::EdgePair<float> best;
        for (unsigned i = 0; i < 15; ++i) {
            const double size = (random() & 1U) != 0 ? 1 : between(random, -1, 1);
            coordinate(best, i) = static_cast<float>(((random() & 1U) != 0 ? 1 : -1) * size *
                                                     (1 - between(random, 0, 0x1p-8)));
        }
        Worst reached;
        keep_worst(reached, best);
        for (unsigned step = 0; step < 200; ++step) {
            sat::EdgePair<float> tried = best;
            float& x = coordinate(tried, static_cast<unsigned>(random() % 15));
            x = (random() & 3U) == 0 ? -x : x * static_cast<float>(1 - between(random, 0, 0x1p-6));
            Worst now;
            keep_worst(now, tried);
            const unsigned aim = round % 3;
            const double was = aim == 0   ? reached.normal
                               : aim == 1 ? reached.cross
                                          : reached.in_plane;
            const double is = aim == 0 ? now.normal : aim == 1 ? now.cross : now.in_plane;
            worst.normal = std::max(worst.normal, now.normal);
            worst.cross = std::max(worst.cross, now.cross);
            worst.in_plane = std::max(worst.in_plane, now.in_plane);
            if (is >= was) {
                reached = now;
                best = tried;
            }
        }
    }
    std::printf("worst share of the bound: normals %.3f, crosses %.3f, in-plane %.3f\n",
                worst.normal, worst.cross, worst.in_plane);
    EXPECT_LE(worst.most(), 1.0);
    EXPECT_GE(worst.normal, 0.03) << "too easy";
    EXPECT_GE(worst.cross, 0.025) << "too easy";
    EXPECT_GE(worst.in_plane, 0.02) << "too easy";
}

struct Tally {
    unsigned pairs = 0, apart = 0, by_shared = 0, by_seventeen = 0, farther = 0, by_margin = 0;
};

enum class Vertices { exact, rounded, displaced };

/// The float vertices lie where the true ones are, or beside them: rounded, or up to `off` away.
template <class T>
void judge(Tally& tally, const CaseKind& kind, PlainTriangle<double> true_a,
           PlainTriangle<double> true_b, Vertices vertices, Random& random) {
    const double off = kind.scale_mm * std::ldexp(1.0, -4 - static_cast<int>(random() % 24));
    sat::TrianglePair<T> p;
    const auto given = [&](std::array<double, 3>& v) {
        std::array<T, 3> c{};
        for (std::size_t k = 0; k < 3; ++k) {
            c[k] = static_cast<T>(v[k]);
            if (vertices == Vertices::exact) {
                v[k] = double(c[k]);
            } else if (vertices == Vertices::displaced) {
                v[k] = double(c[k]) + off * ((random() & 1U) != 0 ? 1 : -1);
            }
        }
        return vector_of(c);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        p.a[i] = given(true_a[i]), p.b[i] = given(true_b[i]);
    }
    const double unit = double(lanes::Traits<T>::kUnit);
    const double least = sizeof(T) == sizeof(float) ? 0x1p-90 : 0;
    const T d = static_cast<T>(
        (vertices == Vertices::displaced ? (1 + 0x1p-20) * 2 * off / (8 * unit) : 0) + least);
    const ExactSquare truth = squared_distance(exact(true_a), exact(true_b));
    const bool apart = sat::separated_shared<false, false>(p.a, p.b, d, T{0});
    EXPECT_EQ(apart, (sat::separated_shared<false, true>(p.a, p.b, d, T{0})));
    ++tally.pairs;
    tally.apart += truth.is_zero() ? 0 : 1;
    tally.by_shared += apart ? 1 : 0;
    EXPECT_TRUE(!apart || !truth.is_zero()) << kind.name << ": told apart, and they touch";
    const double distance_mm = truth.mm();
    for (const double r : {distance_mm * (1 + between(random, -1, 1) * 0x1p-17),
                           distance_mm * (1 - 0x1p-12), distance_mm * between(random, 0, 1),
                           std::ldexp(1.0, static_cast<int>(random() % 44) - 40)}) {
        const double queried_mm = std::max(r, 0x1p-40);
        const bool farther = truth.more_than(queried_mm);
        const bool claimed = sat::separated_shared<true, false>(
            p.a, p.b, d, static_cast<T>(queried_mm * queried_mm * (1 + 0x1p-17)));
        tally.farther += farther ? 1 : 0;
        tally.by_margin += claimed ? 1 : 0;
        EXPECT_TRUE(!claimed || farther)
            << kind.name << ": told farther than " << queried_mm << " of " << distance_mm;
    }
}

template <class T>
void judge_all(const char* format) {
    Random random(printed_seed(20261132));
    std::printf("%s\n%-36s %7s %7s %8s %8s %8s\n", format, "kind", "pairs", "apart", "shared",
                "farther", "shared");
    Tally sum;
    for (const CaseKind& kind : kCaseKinds) {
        Tally t;
        for (unsigned i = 0; i < count_a_kind() && !testing::Test::HasFailure(); ++i) {
            const TriangleCase made =
                make_case(random, kind, sizeof(T) == sizeof(float) ? -30 : -60);
            judge<T>(t, kind, made.a, made.b, static_cast<Vertices>(i % 3), random);
        }
        std::printf("%-36s %7u %7u %8u %8u %8u\n", kind.name, t.pairs, t.apart, t.by_shared,
                    t.farther, t.by_margin);
        sum.by_shared += t.by_shared, sum.apart += t.apart;
        sum.by_margin += t.by_margin, sum.farther += t.farther;
    }
    // A stage that proved next to nothing would pass every test above.
    EXPECT_GT(4 * sum.by_shared, sum.apart);
    EXPECT_GT(8 * sum.by_margin, sum.farther);
}

TEST(SharedAxes, FloatNeverClaimsWhatExactArithmeticDenies) {
    judge_all<float>("float");
}

TEST(SharedAxes, DoubleNeverClaimsWhatExactArithmeticDenies) {
    judge_all<double>("double");
}

}  // namespace
}  // namespace axg::test
#else
TEST(SharedAxes, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
