// SPDX-License-Identifier: Apache-2.0
// Signs of small determinants, exactly: in double where that exceeds the bound of its own rounding,
// else summed without rounding. Bounds: docs/theory/accuracy.md, "Containment".
#pragma once

#include <array>

#include "core/base/exact_sum.hpp"

namespace axg {

struct ExactSign {
    int sign = 0;            // -1, 0 or 1
    bool is_summed = false;  // beyond double
};

/// Sign of a.i b.j - a.j b.i. Entries as two_sum gives them: low is at most half a last bit of
/// high. No product of two entries may fall below 2^-1074.
[[nodiscard]] ExactSign sign_of_turn(const std::array<TwoTerms, 2>& a,
                                     const std::array<TwoTerms, 2>& b) noexcept;

/// Sign of the determinant of three rows. No product of three entries may fall below 2^-1074.
[[nodiscard]] ExactSign sign_of_volume(const std::array<std::array<TwoTerms, 3>, 3>& rows) noexcept;

}  // namespace axg
