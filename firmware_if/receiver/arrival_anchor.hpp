// SPDX-License-Identifier: Apache-2.0
// Numbers the samples of frames that carry neither SYNC nor counter: by their arrival, against an
// anchor that follows the board's period slowly. Rounding each gap by itself would count late
// arrivals twice. Pure. Source: docs/reference/protocol.md, "Signals".
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware_if/receiver/period_watch.hpp"

namespace axg {

/// Largest jitter of arrivals, as a share of a period.
inline constexpr double kArrivalJitterShareMax = 0.96;

struct ArrivalAnchor {
    std::int64_t period_us = 1;
    // Largest lateness of an arrival against another; at most kArrivalJitterShareMax of a period.
    std::int64_t jitter_us = 0;
    bool has_sample = false;
    std::int64_t early_us = 0;  // not before the newest sample's arrival without delay
    std::int64_t late_us = 0;   // not after its arrival with the largest delay seen
};

struct ArrivalNumber {
    std::uint32_t steps = 1;  // samples since the last arrival
    bool is_in_time = true;   // false: there is more jitter than is assumed
};

/// One arrival; never before the last one. Its number is the smallest one at which it is not too
/// late, and newer than the last.
/// Proof: delays are in [0, jitter], and `early_us` is never below an arrival without delay, for it
/// rises by as much as a period may be off. So no number runs ahead, and while nothing is lost each
/// is exact. After a loss a number may be one too small: by the delay of the first arrival, by that
/// of the newest, and by what `early_us` rises too fast, two percent of a period each. Over the
/// stored samples (at most 36 periods with all losses) that is 0.96 + 0.96 + 0.72 periods:
/// two numbers too small, an error of two periods. With a quarter of a period of jitter none is.
[[nodiscard]] constexpr ArrivalNumber number_arrival(ArrivalAnchor& anchor,
                                                     std::int64_t arrived_us) noexcept {
    constexpr std::int64_t kStepsMax = 1'000'000;
    if (!anchor.has_sample) {
        anchor.has_sample = true;
        anchor.early_us = anchor.late_us = arrived_us;
        return {};
    }
    const std::int64_t period = anchor.period_us;
    // The longest time that a period may last, and the resolution of a stamp.
    const std::int64_t longest_us = period + period / kPeriodPart;
    const std::int64_t over_us = arrived_us - anchor.early_us - anchor.jitter_us - 1;
    const std::int64_t rounded_up = over_us > 0 ? (over_us + longest_us - 1) / longest_us : 0;
    const std::int64_t steps = std::clamp<std::int64_t>(rounded_up, 1, kStepsMax);
    const std::int64_t elapsed_us = steps * period;
    const std::int64_t drift_us = elapsed_us / kPeriodPart + 1;
    anchor.early_us = std::min(anchor.early_us + elapsed_us + drift_us, arrived_us);
    // Across a gap, or where numbers were one too small, older delays are not comparable.
    anchor.late_us =
        steps > 1 ? arrived_us : std::max(anchor.late_us + elapsed_us - drift_us, arrived_us);
    return {static_cast<std::uint32_t>(steps),
            anchor.late_us - anchor.early_us <= anchor.jitter_us};
}

}  // namespace axg
