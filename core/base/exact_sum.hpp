// SPDX-License-Identifier: Apache-2.0
// Sums and products of doubles without rounding: a sum is a list of doubles that do not overlap.
// Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates, 1997. Exact as long as nothing overflows and no product falls below 2^-1074.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace axg {

struct TwoTerms {
    double high, low;  // high + low, exactly
};

[[nodiscard]] inline TwoTerms two_sum(double a, double b) noexcept {
    const double s = a + b;
    const double b_part = s - a;
    return {s, (a - (s - b_part)) + (b - b_part)};
}

[[nodiscard]] inline TwoTerms two_product(double a, double b) noexcept {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
}

/// A growing exact sum of up to kTerms doubles. Its terms stay free of zeros, each larger than all
/// before it together, so the last one has the sign.
template <std::size_t kTerms>
class ExactSum {
  public:
    void add(double value) noexcept {
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < count_; ++i) {
            const TwoTerms t = two_sum(value, term_[i]);
            value = t.high;
            if (t.low != 0) {
                term_[kept++] = t.low;
            }
        }
        if (value != 0) {
            term_[kept++] = value;
        }
        count_ = kept;
    }
    /// sign * a * b
    void add_product(TwoTerms a, TwoTerms b, double sign) noexcept {
        for (const double x : {a.high, a.low}) {
            for (const double y : {b.high, b.low}) {
                const TwoTerms p = two_product(sign * x, y);
                add(p.high);
                add(p.low);
            }
        }
    }
    /// sign * a * b * c
    void add_product(TwoTerms a, TwoTerms b, TwoTerms c, double sign) noexcept {
        for (const double x : {a.high, a.low}) {
            for (const double y : {b.high, b.low}) {
                const TwoTerms p = two_product(sign * x, y);
                add_product(p, c, 1.0);
            }
        }
    }
    /// -1, 0 or 1.
    [[nodiscard]] int sign() const noexcept {
        const double most = count_ == 0 ? 0.0 : term_[count_ - 1];
        return most > 0 ? 1 : most < 0 ? -1 : 0;
    }

  private:
    std::array<double, kTerms> term_{};
    std::uint32_t count_ = 0;
};

}  // namespace axg
