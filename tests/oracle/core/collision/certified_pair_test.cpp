// SPDX-License-Identifier: Apache-2.0
// The certified test of one pair of triangles against exact arithmetic: what it claims is true, for
// float and double, for every kind of contact, and what it cannot tell is narrow. The number of
// pairs a kind: AXG_COUNT.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "core/collision/closest_direction.hpp"
#include "core/collision/tri_sat.hpp"
#include "tests/support/count.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

template <class T>
PlainTriangle<T> rounded(const PlainTriangle<double>& t) {
    PlainTriangle<T> out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            out[i][k] = static_cast<T>(t[i][k]);
        }
    }
    return out;
}

/// The pair less an origin, as the engine hands it over; the vertices are exact, so d is the least
/// that the theorem allows.
template <class T>
sat::TrianglePair<T> local_pair(const PlainTriangle<T>& a, const PlainTriangle<T>& b,
                                const std::array<T, 3>& origin) {
    sat::TrianglePair<T> p;
    T most[3] = {0, 0, 0};
    const auto local = [&](const std::array<T, 3>& v) {
        T c[3];
        for (std::size_t k = 0; k < 3; ++k) {
            c[k] = v[k] - origin[k];
            most[k] = std::max(most[k], std::fabs(c[k]));
        }
        return sat::V3<T>{c[0], c[1], c[2]};
    };
    for (std::size_t i = 0; i < 3; ++i) {
        p.a[i] = local(a[i]);
        p.b[i] = local(b[i]);
    }
    const T d = sizeof(T) == sizeof(float) ? static_cast<T>(0x1p-90) : T{0};
    p.scale = {sat::scale_of(most[0], d), sat::scale_of(most[1], d), sat::scale_of(most[2], d)};
    return p;
}

/// r' of the theorem, as core/collision/traverse.inl makes it.
template <class T>
T margin_of(double r) {
    return sizeof(T) == sizeof(float) ? static_cast<T>(r * (1.0 + 0x1p-20) * (1.0 + 0x1p-22))
                                      : static_cast<T>(r * (1.0 + 0x1p-48));
}

struct PairTally {
    unsigned pairs = 0, apart = 0, claims = 0, undecided = 0;
    double widest_mm = 0, widest_relative = 0;  // of pairs that neither axes nor direction decide
};

template <class T>
class Judge {
  public:
    Judge(const CaseKind& kind, Random& random) : kind_(kind), random_(random) {}

    void run(unsigned count) {
        for (unsigned i = 0; i < count && !testing::Test::HasFailure(); ++i) {
            const TriangleCase made =
                make_case(random_, kind_, sizeof(T) == sizeof(float) ? -30 : -60);
            one(rounded<T>(made.a), rounded<T>(made.b));
        }
    }
    [[nodiscard]] const PairTally& tally() const { return tally_; }

  private:
    void one(const PlainTriangle<T>& a, const PlainTriangle<T>& b) {
        const ExactSquare truth = squared_distance(exact(a), exact(b));
        const double distance_mm = truth.mm();
        std::array<T, 3> origin = a[0];
        if ((random_() & 1U) != 0) {
            for (T& x : origin) {
                x += static_cast<T>(between(random_, -1, 1) * kind_.scale_mm);
            }
        }
        const sat::TrianglePair<T> p = local_pair(a, b, origin);
        const sat::PairAxes<T> axes = sat::axes_of(p);
        const sat::V3<T> direction = sat::closest_direction(p, axes).direction;
        const bool by_17 = sat::separated_17<false>(p, T{0});
        const bool by_wide = sat::separated_17_wide<false>(p, axes, T{0});
        const bool by_direction = sat::separates<false>(p, direction, T{0});
        EXPECT_EQ(by_17, by_wide) << kind_.name;
        const bool told = by_17 || by_direction;
        claim(told, !truth.is_zero(), "apart", 0);
        count(p, told, truth.is_zero(), distance_mm);
        certified(p, direction, truth);
        for (int i = 0; i < 3; ++i) {
            const sat::V3<T> any = some_vector(p);
            claim(sat::separates<false>(p, any, T{0}), !truth.is_zero(), "any vector", 0);
            certified(p, any, truth);
        }
        for (const double r : {distance_mm * (1 + between(random_, -1, 1) * 0x1p-18),
                               distance_mm * (1 + between(random_, -1, 1) * 0x1p-46), distance_mm,
                               std::ldexp(1.0, static_cast<int>(random_() % 44) - 40)}) {
            const double queried_mm = std::max(r, 0x1p-40);
            const T margin = margin_of<T>(queried_mm);
            const bool farther = truth.more_than(queried_mm);
            claim(sat::separated_17<true>(p, margin), farther, "17 axes and r", queried_mm);
            claim(sat::separated_17_wide<true>(p, axes, margin), farther, "wide and r", queried_mm);
            claim(sat::separates<true>(p, direction, margin), farther, "direction and r",
                  queried_mm);
        }
    }

    void claim(bool claimed, bool is_true, const char* what, double r) {
        tally_.claims += claimed ? 1 : 0;
        EXPECT_TRUE(!claimed || is_true) << kind_.name << ": " << what << ", r " << r
                                         << ": claimed, and exact arithmetic denies";
    }

    void certified(const sat::TrianglePair<T>& p, const sat::V3<T>& l, const ExactSquare& truth) {
        const double c = sat::certified_distance(p, l);
        claim(c > 0, c > 0 && truth.at_least(c), "certified distance", c);
    }

    /// Any finite vector is legitimate: now a random one, now a difference of two vertices.
    sat::V3<T> some_vector(const sat::TrianglePair<T>& p) {
        if ((random_() & 1U) != 0) {
            return sat::sub(p.b[random_() % 3], p.a[random_() % 3]);
        }
        const double size = std::ldexp(1.0, static_cast<int>(random_() % 60) - 30);
        const auto x = [&] { return static_cast<T>(between(random_, -1, 1) * size); };
        return {x(), x(), x()};
    }

    void count(const sat::TrianglePair<T>& p, bool told, bool touch, double distance_mm) {
        ++tally_.pairs;
        tally_.apart += touch ? 0 : 1;
        if (told || touch) {
            return;
        }
        ++tally_.undecided;
        // scale is 9u (M + d): the band in the theorem's own unit
        const double unit_mm = static_cast<double>(p.scale.x + p.scale.y + p.scale.z);
        tally_.widest_mm = std::max(tally_.widest_mm, distance_mm);
        tally_.widest_relative = std::max(tally_.widest_relative, distance_mm / unit_mm);
    }

    const CaseKind& kind_;
    Random& random_;
    PairTally tally_;
};

/// Runs every kind; returns the widest undecided distance in units of 9u (Mx + My + Mz).
template <class T>
double judge_all_pairs(const char* format) {
    Random random(printed_seed(20261121));
    std::printf("%s\n%-36s %7s %7s %8s %10s %12s %9s\n", format, "kind", "pairs", "apart", "claims",
                "undecided", "widest um", "relative");
    double relative = 0;
    for (const CaseKind& kind : kCaseKinds) {
        Judge<T> judge(kind, random);
        judge.run(count_a_kind());
        const PairTally& t = judge.tally();
        std::printf("%-36s %7u %7u %8u %10u %12.4g %9.3g\n", kind.name, t.pairs, t.apart, t.claims,
                    t.undecided, 1e3 * t.widest_mm, t.widest_relative);
        if (kind.scale_mm >= 1e-4) {  // below, the constant 2^-100 of the bound takes over
            relative = std::max(relative, t.widest_relative);
        }
    }
    return relative;
}

TEST(CertifiedPair, FloatNeverClaimsWhatExactArithmeticDenies) {
    EXPECT_LE(judge_all_pairs<float>("float"), 1.0);
}

TEST(CertifiedPair, DoubleNeverClaimsWhatExactArithmeticDenies) {
    EXPECT_LE(judge_all_pairs<double>("double"), 1.0);
}

/// A point beside an axis, less the origin, and how wrong its computed projection is.
struct Projected {
    std::array<float, 3> vertex{};
    double error = 0, truth = 0;
};

/// Points whose coordinates, products and sums all lie just above a power of two, where one
/// rounding costs most. `truth` is good to 2^-50, which is enough to choose by.
std::vector<Projected> hard_points(Random& random, const sat::V3<float>& l,
                                   const std::array<float, 3>& origin) {
    std::vector<Projected> out(4000);
    const float along[3] = {l.x, l.y, l.z};
    for (std::size_t i = 0; i < out.size(); ++i) {
        Projected& point = out[i];
        const double wanted = i % 2 == 0 ? 1 : -1;  // which way the coordinates are rounded
        float c[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const double size = k == 0 ? 1 : 0.5;
            double most = -HUGE_VAL;
            for (unsigned tried = 0; tried < 8; ++tried) {
                const auto x = static_cast<float>(double(origin[k]) +
                                                  size * (1 + between(random, 0, 0x1p-18)));
                const float local = x - origin[k];
                const double error = double(local) - (double(x) - double(origin[k]));
                if (wanted * error > most) {
                    most = wanted * error;
                    point.vertex[k] = x;
                    c[k] = local;
                }
            }
            point.truth += double(along[k]) * (double(point.vertex[k]) - double(origin[k]));
        }
        point.error = double(sat::dot3(l, sat::V3<float>{c[0], c[1], c[2]})) - point.truth;
    }
    std::sort(out.begin(), out.end(),
              [](const Projected& x, const Projected& y) { return x.error < y.error; });
    return out;
}

/// Two of them at nearly the same place along the axis, whose errors add up to the largest gap.
std::pair<Projected, Projected> worst_of(const std::vector<Projected>& points) {
    constexpr std::size_t kTried = 40;
    std::pair<Projected, Projected> best;
    double most = -HUGE_VAL;
    for (std::size_t i = 0; i < kTried; ++i) {
        for (std::size_t j = points.size() - kTried; j < points.size(); ++j) {
            const Projected &a = points[i], &b = points[j];
            const double apart = b.truth - a.truth;
            const double surplus = apart + b.error - a.error - std::fabs(apart);
            if (surplus > most) {
                most = surplus;
                best = {a, b};
            }
        }
    }
    return best;
}

// The constant of the bound is not decoration: roundings that all go one way come near it, and
// what is then certified along the axis is still no more than the distance along the axis.
TEST(CertifiedPair, RoundingsThatAllGoOneWayStayWithinTheBound) {
    Random random(printed_seed(20261124));
    double worst = 0;  // of the computed gap's surplus, in units of u <|L|,M>
    for (unsigned i = 0; i < std::max(100U, count_a_kind() / 5); ++i) {
        const auto near_one = [&] { return static_cast<float>(1 + between(random, 0, 0x1p-12)); };
        const sat::V3<float> l{near_one(), near_one(), near_one()};
        std::array<float, 3> origin{};
        for (std::size_t k = 0; k < 3; ++k) {  // the vertices come out finer than their differences
            origin[k] = static_cast<float>(-(k == 0 ? 1 : 0.5) * between(random, 0.97, 0.99));
        }
        const auto [from, to] = worst_of(hard_points(random, l, origin));
        const auto p = local_pair<float>({from.vertex, from.vertex, from.vertex},
                                         {to.vertex, to.vertex, to.vertex}, origin);
        const double sum = double(l.x) * p.scale.x + double(l.y) * p.scale.y +
                           double(l.z) * p.scale.z;  // 9u <|L|,M'>
        const double apart = to.truth - from.truth;
        const double surplus = apart + to.error - from.error - std::fabs(apart);
        worst = std::max(worst, 9 * surplus / sum);
        const Dyadic claimed(std::max(0.0, double(sat::certified_distance(p, l))));
        Dyadic along(0.0), square(0.0);
        const float axis[3] = {l.x, l.y, l.z};
        for (std::size_t k = 0; k < 3; ++k) {
            const Dyadic lk(axis[k]);
            along = along + lk * (Dyadic(to.vertex[k]) - Dyadic(from.vertex[k]));
            square = square + lk * lk;
        }
        EXPECT_GE((along * along - claimed * claimed * square).sign(), 0)
            << "certified more than the distance along the axis";
    }
    std::printf("roundings that all go one way: %.3g of the 8 u <|L|,M> that the proof allows\n",
                worst);
    EXPECT_LE(worst, 8.0);
    EXPECT_GE(worst, 4.0) << "these cases are too easy to tell anything";
}

}  // namespace
}  // namespace axg::test
#else
TEST(CertifiedPair, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
