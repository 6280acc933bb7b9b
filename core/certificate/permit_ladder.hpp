// SPDX-License-Identifier: Apache-2.0
// The n that a longer permit is proven with: few, so that the longest that fits is found soon. The
// first stage asks of each pair one box for the least n and one for a longer one. What is proven
// with the longer is proven with every smaller: its motions include theirs. If all pairs are, the
// permit has the longer n, else the least; then comes the next, up after a proof, down after none.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/machine/can_layout.hpp"

namespace axg {

/// With an enforced cap every cycle tries the same longer n, and the cap falls where it fails: ten
/// samples lose next to no permit by chance (docs/reference/machine-file.md).
inline constexpr std::uint8_t kSamplesWork = 10;
[[nodiscard]] constexpr std::uint8_t samples_work(PermitSamples range) noexcept {
    return kSamplesWork > range.least ? std::min(kSamplesWork, range.most) : range.most;
}

inline constexpr std::array<std::uint8_t, 7> kSamplesTried{4, 5, 6, 8, 10, 12, 15};

/// The next higher, the most at last.
[[nodiscard]] constexpr std::uint8_t samples_above(PermitSamples range,
                                                   std::uint8_t samples) noexcept {
    for (const std::uint8_t tried : kSamplesTried) {
        if (tried > samples) {
            return std::min(tried, range.most);
        }
    }
    return range.most;
}

/// The next lower, never `least` where there is one above it.
[[nodiscard]] constexpr std::uint8_t samples_below(PermitSamples range,
                                                   std::uint8_t samples) noexcept {
    std::uint8_t next = range.least;
    for (const std::uint8_t tried : kSamplesTried) {
        next = tried < samples ? tried : next;
    }
    return next > range.least ? next : samples_above(range, range.least);
}

}  // namespace axg
