// SPDX-License-Identifier: Apache-2.0
// The compiled-in sine and cosine against libm in long double: uniform arguments over the whole
// range, dense ones near the multiples of pi/2 where the reduction cancels. Largest error of 1.2e6
// arguments, 2026-11-21, g++ 12 on x86-64, by tests/unit_tests sincos_test: 0.88 ulp.
#include "core/base/sincos.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "tests/support/seed.hpp"

namespace {

using namespace axg;

constexpr double kUlpsMax = 1.0;

/// Error in units of the last place of the true value.
double ulps(double got, long double wanted) {
    int exponent = 0;
    (void)std::frexp(static_cast<double>(wanted), &exponent);
    const long double unit = std::ldexp(1.0L, exponent - 53);
    return static_cast<double>(std::fabs((static_cast<long double>(got) - wanted) / unit));
}

struct Worst {
    double ulp = 0, at = 0;

    void take(double x) {
        const SinCos sc = sin_cos(x);
        const double error = std::fmax(ulps(sc.sin, std::sin(static_cast<long double>(x))),
                                       ulps(sc.cos, std::cos(static_cast<long double>(x))));
        if (!(error <= ulp)) {
            ulp = error;
            at = x;
        }
    }
};

TEST(SinCos, IsWithinOneUlpOfTheTrueValue) {
    static_assert(sizeof(long double) > sizeof(double), "the reference needs more digits");
    std::mt19937_64 random(axg::test::printed_seed(3));
    Worst worst;
    std::uniform_real_distribution<double> wide(-kSinCosArgumentMax, kSinCosArgumentMax);
    std::uniform_real_distribution<double> turn(-7, 7), near(-1e-3, 1e-3);
    std::uniform_int_distribution<int> quarter(-63661, 63661);
    for (int i = 0; i < 400000; ++i) {
        worst.take(wide(random));
        worst.take(turn(random));
        worst.take(quarter(random) * (kPi / 2) + near(random));
    }
    std::printf("worst of 1.2e6 arguments: %.3f ulp at %.17g\n", worst.ulp, worst.at);
    EXPECT_LT(worst.ulp, kUlpsMax);
}

TEST(SinCos, IsExactWhereItMustBe) {
    EXPECT_EQ(sin_cos(0.0).sin, 0.0);
    EXPECT_EQ(sin_cos(0.0).cos, 1.0);
    for (const double x : {0.5, 1.5, 3.0, 1e5}) {
        EXPECT_EQ(sin_cos(-x).sin, -sin_cos(x).sin);
        EXPECT_EQ(sin_cos(-x).cos, sin_cos(x).cos);
    }
}

}  // namespace
