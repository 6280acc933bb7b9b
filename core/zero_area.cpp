// SPDX-License-Identifier: Apache-2.0
// Sums of doubles without rounding, after Shewchuk, Adaptive Precision Floating-Point Arithmetic
// and Fast Robust Geometric Predicates, 1997: a sum is a list of doubles that do not overlap; it is
// zero exactly if all of them are.
#include "core/zero_area.hpp"

#include <array>
#include <cmath>
#include <cstdint>

namespace axg {
namespace {

struct TwoTerms {
    double high, low;  // high + low, exactly
};

TwoTerms two_sum(double a, double b) noexcept {
    const double s = a + b;
    const double b_part = s - a;
    return {s, (a - (s - b_part)) + (b - b_part)};
}

TwoTerms two_product(double a, double b) noexcept {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
}

/// A growing exact sum of up to 16 doubles.
class ExactSum {
  public:
    void add(double value) noexcept {
        for (std::uint32_t i = 0; i < count_; ++i) {
            const TwoTerms t = two_sum(value, term_[i]);
            term_[i] = t.low;
            value = t.high;
        }
        term_[count_++] = value;
    }
    void add_product(TwoTerms a, TwoTerms b, double sign) noexcept {
        for (const double x : {a.high, a.low}) {
            for (const double y : {b.high, b.low}) {
                const TwoTerms p = two_product(sign * x, y);
                add(p.high);
                add(p.low);
            }
        }
    }
    [[nodiscard]] bool is_zero() const noexcept {
        for (std::uint32_t i = 0; i < count_; ++i) {
            if (term_[i] != 0) {
                return false;
            }
        }
        return true;
    }

  private:
    std::array<double, 16> term_{};
    std::uint32_t count_ = 0;
};

/// u v' - u' v for the differences of two corners to a third, in one coordinate plane.
bool is_zero_in_plane(double ax, double ay, double bx, double by, double cx, double cy) noexcept {
    const TwoTerms ux = two_sum(bx, -ax), uy = two_sum(by, -ay);
    const TwoTerms vx = two_sum(cx, -ax), vy = two_sum(cy, -ay);
    const double left = ux.high * vy.high, right = uy.high * vx.high;
    // Five roundings at most in each product: a difference that large has its true sign.
    if (std::fabs(left - right) > 0x1p-50 * (std::fabs(left) + std::fabs(right))) {
        return false;
    }
    ExactSum sum;
    sum.add_product(ux, vy, 1.0);
    sum.add_product(uy, vx, -1.0);
    return sum.is_zero();
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
