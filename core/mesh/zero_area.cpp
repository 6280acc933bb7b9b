// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/zero_area.hpp"

#include "core/base/exact_sign.hpp"

namespace axg {
namespace {

/// u v' - u' v for the differences of two corners to a third, in one coordinate plane.
bool is_zero_in_plane(double ax, double ay, double bx, double by, double cx, double cy) noexcept {
    return sign_of_turn({two_sum(bx, -ax), two_sum(by, -ay)}, {two_sum(cx, -ax), two_sum(cy, -ay)})
               .sign == 0;
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
