// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/judge/exact_signs.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace axg::lab {

namespace {

__extension__ using Wide = __int128;  // a determinant needs at most 126 bits and a sign

thread_local SignCounts counts;

int sign_of(double x) {
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// The coordinates as whole numbers of one power of two, at most 2^40; false where they do not fit.
bool whole_numbers(std::span<const double> from, std::span<std::int64_t> to) {
    double most = 0;
    for (const double x : from) {
        most = std::max(most, std::fabs(x));
    }
    int exponent = 0;
    std::frexp(most, &exponent);
    if (exponent < -900) {
        return false;
    }
    const double scale = std::ldexp(1.0, 40 - exponent);
    for (std::size_t i = 0; i < from.size(); ++i) {
        const double x = from[i] * scale;  // a power of two: exact, or below 1 where it underflows
        to[i] = static_cast<std::int64_t>(x);
        if (static_cast<double>(to[i]) != x || (x == 0) != (from[i] == 0)) {
            return false;
        }
    }
    return true;
}

/// The same without a limit: GMP's whole numbers, of the power of two that all of them share.
void any_whole_numbers(std::span<const double> from, std::span<mpz_class> to) {
    int least = 2000;
    for (const double x : from) {
        int exponent = 0;
        std::frexp(x, &exponent);
        least = x == 0 ? least : std::min(least, exponent - 53);
    }
    for (std::size_t i = 0; i < from.size(); ++i) {
        int exponent = 0;
        to[i] = std::ldexp(std::frexp(from[i], &exponent), 53);
        to[i] <<= static_cast<mp_bitcnt_t>(from[i] == 0 ? 0 : exponent - 53 - least);
    }
}

template <class Number, class Coordinate>
Number determinant_3(std::span<const Coordinate> p) {
    Number m[3][3];
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            m[i][k] = p[3 * i + 3 + k] - p[k];
        }
    }
    const Number x = m[0][1] * m[1][2] - m[0][2] * m[1][1];
    const Number y = m[0][2] * m[1][0] - m[0][0] * m[1][2];
    const Number z = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    return x * m[2][0] + y * m[2][1] + z * m[2][2];
}

template <class Number, class Coordinate>
Number determinant_2(std::span<const Coordinate> p) {
    const Number ux = p[2] - p[0], uy = p[3] - p[1], vx = p[4] - p[0], vy = p[5] - p[1];
    return ux * vy - uy * vx;
}

/// Differences of 40-bit numbers have 41, products of two 82, their differences 83, products of
/// three 124, three of them 126 bits.
template <std::size_t kCount>
int exact_sign(const std::array<double, kCount>& p) {
    constexpr bool kSpace = kCount == 12;
    std::array<std::int64_t, kCount> whole;
    if (whole_numbers(p, whole)) {
        ++counts.by_integers;
        Wide found{};
        if constexpr (kSpace) {
            found = determinant_3<Wide, std::int64_t>(whole);
        } else {
            found = determinant_2<Wide, std::int64_t>(whole);
        }
        return found > 0 ? 1 : found < 0 ? -1 : 0;
    }
    ++counts.by_gmp;
    std::array<mpz_class, kCount> any;
    any_whole_numbers(p, any);
    if constexpr (kSpace) {
        return sgn(determinant_3<mpz_class, mpz_class>(any));
    } else {
        return sgn(determinant_2<mpz_class, mpz_class>(any));
    }
}

/// The error of a computed determinant is at most 16 v times the sum of the sizes of its terms
/// (v = 2^-53). Every term passes through at most three differences, two products and four
/// sums, so its computed size is within a factor (1 + v)^9 of the true one, and 16 covers that and
/// the rounding of this bound itself. A product that underflows is off by less than 2^-1074, times
/// a coordinate below kMost that is far less than what is left over of a sum above kLeast. Infinity
/// and NaN fail the comparison.
constexpr double kErrorShare = 0x1p-49;
constexpr double kLeast = 0x1p-900, kMost = 0x1p100;

}  // namespace

int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const Vec3d u = b - a, v = c - a, w = d - a;
    const double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z;
    const double xy = u.x * v.y, yx = u.y * v.x;
    const double found = (yz - zy) * w.x + (zx - xz) * w.y + (xy - yx) * w.z;
    const double sizes = (std::fabs(yz) + std::fabs(zy)) * std::fabs(w.x) +
                         (std::fabs(zx) + std::fabs(xz)) * std::fabs(w.y) +
                         (std::fabs(xy) + std::fabs(yx)) * std::fabs(w.z);
    const double most = std::max({std::fabs(w.x), std::fabs(w.y), std::fabs(w.z)});
    if (std::fabs(found) > kErrorShare * sizes && sizes > kLeast && most < kMost) {
        ++counts.by_double;
        return sign_of(found);
    }
    return exact_sign<12>({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z});
}

int orientation(const Flat& a, const Flat& b, const Flat& c) {
    const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
    const double found = left - right, sizes = std::fabs(left) + std::fabs(right);
    if (std::fabs(found) > kErrorShare * sizes && sizes > kLeast) {
        ++counts.by_double;
        return sign_of(found);
    }
    return exact_sign<6>({a.x, a.y, b.x, b.y, c.x, c.y});
}

SignCounts sign_counts() {
    return counts;
}

}  // namespace axg::lab
