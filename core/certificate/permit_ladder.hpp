// SPDX-License-Identifier: Apache-2.0
// The values of n for longer permits: few, so that the search finds the longest proven n soon.
// Stage 1 queries one box of each pair for the least n and one for a longer n. A proof for the
// longer n covers every smaller n: its motions include theirs. If it succeeds for all pairs, the
// permit has the longer n, else the least. The next cycle tries the next higher n after a proof,
// else the next lower. An n that fails right after the proof of a shorter one is not tried for
// kCyclesBarred cycles. Otherwise every second permit would have the least n whenever the longest
// provable n is between two values.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/machine/can_layout.hpp"

namespace axg {

/// With an enforced cap every cycle tries the same longer n, and the cap falls if that fails. With
/// ten samples, chance loses almost no permit (docs/reference/machine-file.md).
inline constexpr std::uint8_t kSamplesWork = 10;
[[nodiscard]] constexpr std::uint8_t samples_work(PermitSamples range) noexcept {
    return kSamplesWork > range.least ? std::min(kSamplesWork, range.most) : range.most;
}

inline constexpr std::array<std::uint8_t, 7> kSamplesTried{4, 5, 6, 8, 10, 12, 15};

/// The next higher n, at most range.most.
[[nodiscard]] constexpr std::uint8_t samples_above(PermitSamples range,
                                                   std::uint8_t samples) noexcept {
    for (const std::uint8_t tried : kSamplesTried) {
        if (tried > samples) {
            return std::min(tried, range.most);
        }
    }
    return range.most;
}

/// The next lower n; returns range.least only if there is no n above it.
[[nodiscard]] constexpr std::uint8_t samples_below(PermitSamples range,
                                                   std::uint8_t samples) noexcept {
    std::uint8_t next = range.least;
    for (const std::uint8_t tried : kSamplesTried) {
        next = tried < samples ? tried : next;
    }
    return next > range.least ? next : samples_above(range, range.least);
}

/// Cycles without a new attempt of an n that failed right after a shorter one was proven.
inline constexpr std::uint8_t kCyclesBarred = 32;

struct PermitLadder {
    std::uint8_t samples = 0;  // the longer n that the cycle tries
    std::uint8_t barred = 0, cycles_barred = 0;
    bool is_climb = false;  // the previous cycle proved a shorter n

    /// State after a cycle that tried `samples`.
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
