// SPDX-License-Identifier: Apache-2.0
// Three-vectors as plain data. Evaluation order is part of the contract: no contraction, see
// docs/theory/accuracy.md.
#pragma once

#include "core/base/host_device.hpp"

namespace axg {

template <class T>
struct Vec3 {
    T x{}, y{}, z{};

    // Implicitly constexpr if T's is; with the keyword clang would refuse rational coordinates.
    friend bool operator==(const Vec3&, const Vec3&) = default;
};
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T>
AXG_HD constexpr Vec3<T> operator+(Vec3<T> a, Vec3<T> b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
AXG_HD constexpr Vec3<T> operator-(Vec3<T> a, Vec3<T> b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
AXG_HD constexpr Vec3<T> operator*(T s, Vec3<T> a) noexcept {
    return {s * a.x, s * a.y, s * a.z};
}
template <class T>
AXG_HD constexpr T dot(Vec3<T> a, Vec3<T> b) noexcept {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class T>
AXG_HD constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
AXG_HD constexpr Vec3d widen(Vec3f a) noexcept {
    return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

}  // namespace axg
