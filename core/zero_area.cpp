// SPDX-License-Identifier: Apache-2.0
#include "core/zero_area.hpp"

#include <cmath>

#include "core/exact_sum.hpp"

namespace axg {
namespace {

/// u v' - u' v for the differences of two corners to a third, in one coordinate plane.
bool is_zero_in_plane(double ax, double ay, double bx, double by, double cx, double cy) noexcept {
    const TwoTerms ux = two_sum(bx, -ax), uy = two_sum(by, -ay);
    const TwoTerms vx = two_sum(cx, -ax), vy = two_sum(cy, -ay);
    const double left = ux.high * vy.high, right = uy.high * vx.high;
    // Five roundings at most in each product: a difference that large has its true sign.
    if (std::fabs(left - right) > 0x1p-50 * (std::fabs(left) + std::fabs(right))) {
        return false;
    }
    ExactSum<16> sum;
    sum.add_product(ux, vy, 1.0);
    sum.add_product(uy, vx, -1.0);
    return sum.sign() == 0;
}

}  // namespace

bool has_zero_area(const Triangle& t) noexcept {
    if (t.a == t.b || t.b == t.c || t.c == t.a) {
        return true;  // the usual kind, without the long sum
    }
    const Vec3d a = widen(t.a), b = widen(t.b), c = widen(t.c);
    return is_zero_in_plane(a.x, a.y, b.x, b.y, c.x, c.y) &&
           is_zero_in_plane(a.y, a.z, b.y, b.z, c.y, c.z) &&
           is_zero_in_plane(a.z, a.x, b.z, b.x, c.z, c.x);
}

}  // namespace axg
