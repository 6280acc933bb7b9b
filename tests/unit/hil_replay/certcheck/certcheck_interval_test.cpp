// SPDX-License-Identifier: Apache-2.0
// Intervals contain what is exact: each operation against its error, which a fused operation gives,
// and sines against long double.
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "hil_replay/certcheck/interval.hpp"

namespace axg::certcheck {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Numbers of all sizes and signs, as far as products do not leave the range.
double any_number(std::mt19937_64& random) {
    const double fraction = std::uniform_real_distribution<double>(-1, 1)(random);
    return std::ldexp(fraction, std::uniform_int_distribution<int>(-300, 300)(random));
}

TEST(CertcheckInterval, RoundsOutwardsByAtLeastOnePlace) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 300000; ++i) {
        const double x = i < 100000 ? any_number(random)
                                    : std::bit_cast<double>(random() & ~(std::uint64_t{1} << 62U));
        EXPECT_GE(above(x), std::nextafter(x, kInfinity));
        EXPECT_LE(below(x), std::nextafter(x, -kInfinity));
    }
    for (const double x : {0.0, -0.0, 5e-324, -5e-324, 0x1p-1022, -0x1p-1022, 1.0, -1.0}) {
        EXPECT_GE(above(x), std::nextafter(x, kInfinity));
        EXPECT_LE(below(x), std::nextafter(x, -kInfinity));
    }
}

TEST(CertcheckInterval, ContainsTheExactResult) {
    std::mt19937_64 random(2);
    const auto inside = [](Interval found, double rounded) {
        return found.low < rounded && rounded < found.high;  // so the neighbours are inside too
    };
    for (int i = 0; i < 100000; ++i) {
        const double a = any_number(random);
        const double b = any_number(random);
        EXPECT_TRUE(inside(Interval(a) + b, a + b));
        EXPECT_TRUE(inside(Interval(a) - b, a - b));
        EXPECT_TRUE(inside(Interval(a) * b, a * b));
        EXPECT_TRUE(inside(Interval(a) / b, a / b));
        EXPECT_TRUE(inside(root(std::fabs(a)), std::sqrt(std::fabs(a))));
        EXPECT_TRUE(inside(square(a), a * a));
    }
}

// A member of a result is the result of members: random points of wide intervals.
TEST(CertcheckInterval, ContainsResultsOfMembers) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> number(-2, 2);
    for (int i = 0; i < 100000; ++i) {
        const double a = number(random), b = number(random), c = number(random), d = number(random);
        const Interval x{std::min(a, b), std::max(a, b)};
        const Interval y{std::min(c, d), std::max(c, d)};
        const double p = std::midpoint(a, b);
        const double q = std::midpoint(c, d);
        const auto has = [](Interval all, double one) { return all.low <= one && one <= all.high; };
        EXPECT_TRUE(has(x * y, p * q) && has(x * y, a * d) && has(x + y, p + q));
        EXPECT_TRUE(has(square(x), p * p) && square(x).high >= a * a);
        EXPECT_TRUE(c * d < 0 || has(x / y, p / q));
        EXPECT_TRUE(has(min(x, y), std::min(p, q)) && has(max(x, y), std::max(p, q)));
    }
}

TEST(CertcheckInterval, SinesContainTheExactOnes) {
    std::mt19937_64 random(4);
    for (int i = 0; i < 200000; ++i) {
        const double angle =
            std::uniform_real_distribution<double>(-1, 1)(random) * std::ldexp(1, i % 20);
        const auto [sine, cosine] = sine_cosine(angle);
        const long double exact_sine = sinl(angle);
        const long double exact_cosine = cosl(angle);
        EXPECT_TRUE(sine.low < exact_sine && exact_sine < sine.high) << angle;
        EXPECT_TRUE(cosine.low < exact_cosine && exact_cosine < cosine.high) << angle;
        EXPECT_LT(sine.high - sine.low, 3e-15) << angle;
        EXPECT_LT(cosine.high - cosine.low, 3e-15) << angle;
    }
    for (int i = -8; i <= 8; ++i) {  // near multiples of pi / 2
        const auto [sine, cosine] = sine_cosine(i * 1.5707963267948966);
        EXPECT_TRUE(sine.low < sinl(i * 1.5707963267948966) &&
                    cosine.high > cosl(i * 1.5707963267948966));
    }
}

TEST(CertcheckInterval, TheChordIsThatOfHalfATurnAtMost) {
    for (double w = 0; w < 8; w += 0.001) {
        const double exact = std::sin(std::min(w, 3.14159265358979) / 2);
        EXPECT_GE(sine_of_half(w), exact);
        EXPECT_LE(sine_of_half(w), exact + 1e-14);
    }
}

}  // namespace
}  // namespace axg::certcheck
