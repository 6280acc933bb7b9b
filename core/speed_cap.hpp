// SPDX-License-Identifier: Apache-2.0
// The fastest feed from which a stop still ends clear, in 1/250 of rapid, by asking: advice for the
// board, never part of a proof. Source: docs/states.md, "Hints".
#pragma once

#include <cstdint>

namespace axg {

inline constexpr std::uint32_t kSpeedCapRapid = 250;    // the permit's unit: 1/250 of rapid
inline constexpr std::uint32_t kSpeedCapQuestions = 8;  // 2^8 > 250
static_assert((1U << kSpeedCapQuestions) > kSpeedCapRapid);

/// @param is_stoppable  asked of a feed in 1..250; the answer yes is a proof for that feed
/// @return  a feed for which the answer was yes, 0 if there was none. Where a slower feed is never
///          worse it is the largest there is; where one is, another yes may lie above it.
/// Cost: kSpeedCapQuestions calls, whatever the answers.
template <typename IsStoppable>
[[nodiscard]] std::uint8_t speed_cap(IsStoppable&& is_stoppable) noexcept {
    std::uint32_t proven = 0;  // the largest feed answered with yes
    for (std::uint32_t step = 1U << (kSpeedCapQuestions - 1U); step > 0; step /= 2) {
        // Beyond rapid there is nothing to gain: rapid is asked once more, so that a cycle's work
        // does not depend on the answers.
        const std::uint32_t feed = proven + step < kSpeedCapRapid ? proven + step : kSpeedCapRapid;
        if (is_stoppable(static_cast<std::uint8_t>(feed))) {
            proven = feed;
        }
    }
    return static_cast<std::uint8_t>(proven);
}

}  // namespace axg
