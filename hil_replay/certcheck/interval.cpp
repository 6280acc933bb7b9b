// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/interval.hpp"

namespace axg::certcheck {
namespace {

// pi / 2 in two parts: the first has 33 bits, so a multiple below 2^20 is exact (fdlibm).
constexpr double kHalfPi = 1.57079632673412561417e+00;
constexpr double kHalfPiRest = 6.07710050650619224932e-11;
constexpr double kPiBelow = 3.141592653589793;  // pi exceeds this double by 1.2e-16
constexpr int kTerms = 10;

/// cos x for first 0, sin x / x for first 1, by Horner: 1 - x^2 / 2 (1 - x^2 / 12 (1 - ...)). Every
/// bracket is in (0, 1] for |x| <= 1; the innermost, the remainder, is above 1 - 1 / 440.
Interval series(Interval x_squared, int first) {
    Interval sum{0.99, 1};
    for (int i = kTerms; i >= 1; --i) {
        sum = 1 - x_squared / ((2 * i - 1 + first) * (2 * i + first)) * sum;
    }
    return sum;
}

}  // namespace

SineCosine sine_cosine(double angle) {
    const double turns = std::nearbyint(angle / kHalfPi);
    const Interval rest = turns * Interval{below(kHalfPiRest), above(kHalfPiRest)};
    const Interval x = Interval(angle) - Interval(turns * kHalfPi) - rest;
    const Interval sine = x * series(square(x), 1);
    const Interval cosine = series(square(x), 0);
    switch (static_cast<long>(turns) & 3) {
        case 0:
            return {sine, cosine};
        case 1:
            return {cosine, -sine};
        case 2:
            return {-sine, -cosine};
        default:
            return {-cosine, sine};
    }
}

double sine_of_half(double w) {
    return w < kPiBelow ? std::min(sine_cosine(w / 2).sine.high, 1.0) : 1.0;
}

}  // namespace axg::certcheck
