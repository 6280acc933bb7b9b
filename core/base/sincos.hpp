// SPDX-License-Identifier: Apache-2.0
// Sine and cosine from one implementation compiled in: libm differs between processors, and equal
// bits are a promise. Cody-Waite reduction by pi/2 in three parts (Cody and Waite, 1980), Taylor
// series on [-pi/4, pi/4]: the first term left out is below 1e-19, so the error is that of
// rounding, under 1 ulp for |x| <= 1e5 (tests/unit/core/base/sincos_test.cpp).
#pragma once

namespace axg {

inline constexpr double kPi = 0x1.921fb54442d18p+1;
inline constexpr double kSinCosArgumentMax = 1.0e5;  // rad; the caller refuses more

struct SinCos {
    double sin, cos;
};

constexpr SinCos sin_cos(double x_rad) noexcept {
    constexpr double kHalfPi1 = 0x1.921fb544p+0;        // 33 bits: n * kHalfPi1 is exact below 2^20
    constexpr double kHalfPi2 = 0x1.0b4611a6p-34;       // the next 33
    constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;  // and the rest
    const double turns = x_rad * (2.0 / kPi);
    const long n = static_cast<long>(turns < 0 ? turns - 0.5 : turns + 0.5);
    const double k = static_cast<double>(n);
    // y + low is the reduced argument: near a zero of the sine the rounding of y alone would show.
    const double first = x_rad - k * kHalfPi1;
    const double second = first - k * kHalfPi2;
    const double rest = k * kHalfPi3 - ((first - second) - k * kHalfPi2);
    const double y = second - rest;
    const double low = (second - y) - rest;
    const double z = y * y;
    double s = 1.0 / 355687428096000.0;  // 1/17!, then alternating odd factorials
    s = s * z - 1.0 / 1307674368000.0;
    s = s * z + 1.0 / 6227020800.0;
    s = s * z - 1.0 / 39916800.0;
    s = s * z + 1.0 / 362880.0;
    s = s * z - 1.0 / 5040.0;
    s = s * z + 1.0 / 120.0;
    s = s * z - 1.0 / 6.0;
    s = y + (y * z * s + low);
    double c = 1.0 / 20922789888000.0;  // 1/16!, then alternating even factorials
    c = c * z - 1.0 / 87178291200.0;
    c = c * z + 1.0 / 479001600.0;
    c = c * z - 1.0 / 3628800.0;
    c = c * z + 1.0 / 40320.0;
    c = c * z - 1.0 / 720.0;
    c = c * z + 1.0 / 24.0;
    const double half = 0.5 * z, head = 1.0 - half;
    c = head + (((1.0 - head) - half) + (z * z * c - y * low));
    switch (static_cast<unsigned long>(n) & 3UL) {
        case 0:
            return {s, c};
        case 1:
            return {c, -s};
        case 2:
            return {-s, -c};
        default:
            return {-c, s};
    }
}

}  // namespace axg
