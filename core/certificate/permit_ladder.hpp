// SPDX-License-Identifier: Apache-2.0
// The n that a longer permit is proven with: few, so that the longest that fits is found soon. The
// first stage asks of each pair one box for the least n and one for a longer one. What is proven
// with the longer is proven with every smaller: its motions include theirs. If all pairs are, the
// permit has the longer n, else the least; then comes the next, up after a proof, down after none.
// An n that failed right after a shorter one was proven is left alone for a while: else, where the
// longest lies between two, every second permit would be as short as the least.
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

/// So many cycles an n that was one step too many is not tried again.
inline constexpr std::uint8_t kCyclesBarred = 32;

struct PermitLadder {
    std::uint8_t samples = 0;  // the longer n that a cycle tries
    std::uint8_t barred = 0, cycles_barred = 0;
    bool is_climb = false;  // the cycle before proved a shorter one

    /// After a cycle that tried it.
    [[nodiscard]] constexpr PermitLadder next(PermitSamples range, bool is_proven) const noexcept {
        PermitLadder out = *this;
        out.cycles_barred = std::max<std::uint8_t>(cycles_barred, 1) - 1;
        out.is_climb = false;
        if (!is_proven) {
            if (is_climb) {
                out.barred = samples;
                out.cycles_barred = kCyclesBarred;
            }
            out.samples = samples_below(range, samples);
            return out;
        }
        const std::uint8_t above = samples_above(range, samples);
        const bool is_barred = out.cycles_barred > 0 && above >= out.barred;
        if (above > samples && !is_barred) {
            out.samples = above;
            out.is_climb = true;
        }
        return out;
    }
};

}  // namespace axg
