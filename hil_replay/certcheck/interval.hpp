// SPDX-License-Identifier: Apache-2.0
// Intervals of doubles that contain the exact result. Each operation rounds outwards by one unit in
// the last place or two; no rounding mode is changed. A NaN proves nothing: every judge
// demands a comparison that holds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace axg::certcheck {

/// At least std::nextafter(x, infinity), without its call: |x| 2^-52 is one or two units.
inline double above(double x) {
    return x + (std::fabs(x) * 0x1p-52 + std::numeric_limits<double>::denorm_min());
}
inline double below(double x) {
    return -above(-x);
}

struct Interval {
    double low = 0;
    double high = 0;

    constexpr Interval() = default;
    constexpr Interval(double exact) : low(exact), high(exact) {}  // NOLINT: numbers are exact
    constexpr Interval(double from, double to) : low(from), high(to) {}
};

inline Interval operator-(Interval a) {
    return {-a.high, -a.low};
}
inline Interval operator+(Interval a, Interval b) {
    return {below(a.low + b.low), above(a.high + b.high)};
}
inline Interval operator-(Interval a, Interval b) {
    return a + -b;
}
inline Interval operator*(Interval a, Interval b) {
    const auto [low, high] =
        std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
    return {below(low), above(high)};
}
/// @param b does not contain 0
inline Interval operator/(Interval a, Interval b) {
    const auto [low, high] =
        std::minmax({a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high});
    return {below(low), above(high)};
}
inline Interval square(Interval a) {
    const Interval both = a * a;
    return {a.low > 0 || a.high < 0 ? both.low : 0, both.high};
}
inline Interval min(Interval a, Interval b) {
    return {std::min(a.low, b.low), std::min(a.high, b.high)};
}
inline Interval max(Interval a, Interval b) {
    return {std::max(a.low, b.low), std::max(a.high, b.high)};
}
/// The root of what is not negative.
inline Interval root(Interval a) {
    return {below(std::sqrt(std::max(a.low, 0.0))), above(std::sqrt(std::max(a.high, 0.0)))};
}

struct SineCosine {
    Interval sine, cosine;
};
/// @param angle |angle| <= 2^19 rad
SineCosine sine_cosine(double angle);
/// An upper bound of sin(min(w, pi) / 2), w >= 0.
double sine_of_half(double w);

struct Vector {
    std::array<Interval, 3> at;
    Interval& operator[](std::size_t i) { return at[i]; }
    const Interval& operator[](std::size_t i) const { return at[i]; }
};

inline Vector operator+(const Vector& a, const Vector& b) {
    return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
inline Vector operator-(const Vector& a, const Vector& b) {
    return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
}
inline Vector operator*(Interval k, const Vector& a) {
    return {{k * a[0], k * a[1], k * a[2]}};
}
inline Interval dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector cross(const Vector& a, const Vector& b) {
    return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
inline Interval length(const Vector& a) {
    return root(square(a[0]) + square(a[1]) + square(a[2]));
}

/// p' = R p + t.
struct Pose {
    std::array<Vector, 3> row{{{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
    Vector shift{};
};

inline Vector turned(const Pose& pose, const Vector& p) {
    return {{dot(pose.row[0], p), dot(pose.row[1], p), dot(pose.row[2], p)}};
}
/// R^T p.
inline Vector turned_back(const Pose& pose, const Vector& p) {
    return p[0] * pose.row[0] + p[1] * pose.row[1] + p[2] * pose.row[2];
}
inline Vector placed(const Pose& pose, const Vector& p) {
    return turned(pose, p) + pose.shift;
}
inline Pose operator*(const Pose& a, const Pose& b) {
    Pose product;
    for (std::size_t i = 0; i < 3; ++i) {
        product.row[i] = turned_back(b, a.row[i]);
    }
    product.shift = placed(a, b.shift);
    return product;
}

}  // namespace axg::certcheck
