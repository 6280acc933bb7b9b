// SPDX-License-Identifier: Apache-2.0
// A value with its first three derivatives along a path, and arithmetic on all four: one formula
// gives a position and its derivatives. Units: those of the value, per mm of path.
// Source: Taylor arithmetic, Griewank and Walther, "Evaluating Derivatives", 2008, chapter 13.
#pragma once

#include <array>

#include "core/base/sincos.hpp"

namespace axg {

struct Jet {
    std::array<double, 4> d{};  // value, first, second, third derivative

    constexpr Jet() = default;
    constexpr Jet(double value) : d{value, 0, 0, 0} {}  // NOLINT: a number is a constant jet
    constexpr Jet(double value, double first, double second, double third)
        : d{value, first, second, third} {}
    friend constexpr bool operator==(const Jet&, const Jet&) = default;
};

constexpr Jet operator+(const Jet& a, const Jet& b) noexcept {
    return {a.d[0] + b.d[0], a.d[1] + b.d[1], a.d[2] + b.d[2], a.d[3] + b.d[3]};
}
constexpr Jet operator-(const Jet& a, const Jet& b) noexcept {
    return {a.d[0] - b.d[0], a.d[1] - b.d[1], a.d[2] - b.d[2], a.d[3] - b.d[3]};
}
constexpr Jet operator*(const Jet& a, const Jet& b) noexcept {
    return {a.d[0] * b.d[0], a.d[1] * b.d[0] + a.d[0] * b.d[1],
            a.d[2] * b.d[0] + 2 * a.d[1] * b.d[1] + a.d[0] * b.d[2],
            a.d[3] * b.d[0] + 3 * (a.d[2] * b.d[1] + a.d[1] * b.d[2]) + a.d[0] * b.d[3]};
}
constexpr Jet operator/(const Jet& a, const Jet& b) noexcept {
    Jet q;
    q.d[0] = a.d[0] / b.d[0];
    q.d[1] = (a.d[1] - q.d[0] * b.d[1]) / b.d[0];
    q.d[2] = (a.d[2] - 2 * q.d[1] * b.d[1] - q.d[0] * b.d[2]) / b.d[0];
    q.d[3] = (a.d[3] - 3 * (q.d[2] * b.d[1] + q.d[1] * b.d[2]) - q.d[0] * b.d[3]) / b.d[0];
    return q;
}

template <class Scalar>
struct SinCosOf {
    Scalar sin, cos;
};

constexpr SinCosOf<double> sin_cos_of(double angle) noexcept {
    const SinCos value = sin_cos(angle);
    return {value.sin, value.cos};
}

constexpr SinCosOf<Jet> sin_cos_of(const Jet& angle) noexcept {
    const SinCos value = sin_cos(angle.d[0]);
    SinCosOf<Jet> out{value.sin, value.cos};
    Jet& s = out.sin;
    Jet& c = out.cos;
    const auto& a = angle.d;
    s.d[1] = c.d[0] * a[1];
    c.d[1] = -(s.d[0] * a[1]);
    s.d[2] = c.d[1] * a[1] + c.d[0] * a[2];
    c.d[2] = -(s.d[1] * a[1] + s.d[0] * a[2]);
    s.d[3] = c.d[2] * a[1] + 2 * c.d[1] * a[2] + c.d[0] * a[3];
    c.d[3] = -(s.d[2] * a[1] + 2 * s.d[1] * a[2] + s.d[0] * a[3]);
    return out;
}

}  // namespace axg
