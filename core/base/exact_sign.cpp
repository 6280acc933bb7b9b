// SPDX-License-Identifier: Apache-2.0
#include "core/base/exact_sign.hpp"

#include <cmath>
#include <cstddef>

namespace axg {
namespace {

int sign_of(double x) noexcept {
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

}  // namespace

ExactSign sign_of_turn(const std::array<TwoTerms, 2>& a,
                       const std::array<TwoTerms, 2>& b) noexcept {
    const double left = a[0].high * b[1].high, right = a[1].high * b[0].high;
    if (std::fabs(left - right) > 0x1p-50 * (std::fabs(left) + std::fabs(right))) {
        return {sign_of(left - right), false};
    }
    ExactSum<16> sum;
    sum.add_product(a[0], b[1], 1.0);
    sum.add_product(a[1], b[0], -1.0);
    return {sum.sign(), true};
}

ExactSign sign_of_volume(const std::array<std::array<TwoTerms, 3>, 3>& rows) noexcept {
    double sum = 0, size = 0;
    for (std::size_t n = 0; n < 3; ++n) {
        const auto& b = rows[(n + 1) % 3];
        const auto& c = rows[(n + 2) % 3];
        const double left = b[1].high * c[2].high, right = b[2].high * c[1].high;
        sum += rows[n][0].high * (left - right);
        size += std::fabs(rows[n][0].high) * (std::fabs(left) + std::fabs(right));
    }
    if (std::fabs(sum) > 0x1p-49 * size) {
        return {sign_of(sum), false};
    }
    ExactSum<192> exact;
    for (std::size_t n = 0; n < 3; ++n) {
        const auto& b = rows[(n + 1) % 3];
        const auto& c = rows[(n + 2) % 3];
        exact.add_product(rows[n][0], b[1], c[2], 1.0);
        exact.add_product(rows[n][0], b[2], c[1], -1.0);
    }
    return {exact.sign(), true};
}

}  // namespace axg
