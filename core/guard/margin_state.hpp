// SPDX-License-Identifier: Apache-2.0
// Warn, slow, stop by the clearance of a pair, without flapping: a worse level holds at once, a
// better one only after the clearance has been larger by a band for some cycles. mm.
// Source: docs/reference/states.md, "Advisories".
#pragma once

#include <cstdint>
#include <type_traits>

namespace axg {

/// From worst to best; zeroed memory is stop.
enum class ClearanceLevel : std::uint8_t { stop = 0, slow, warn, clear };

[[nodiscard]] constexpr const char* to_text(ClearanceLevel level) noexcept {
    constexpr const char* kWords[]{"stop", "slow", "warn", "clear"};
    return kWords[static_cast<unsigned>(level) & 3U];
}

/// stop_mm <= slow_mm <= warn_mm; a clearance equal to one of them satisfies it.
struct MarginRule {
    double stop_mm = 0, slow_mm = 0, warn_mm = 0;
    double band_mm = 0;             // twice the noise of the clearance, or more
    std::uint32_t hold_cycles = 1;  // in a row; 0 counts as 1
};

struct MarginState {
    ClearanceLevel level = ClearanceLevel::stop;
    ClearanceLevel better = ClearanceLevel::stop;  // the worst of the cycles held so far
    std::uint32_t held_cycles = 0;
};
static_assert(std::is_trivially_copyable_v<MarginState>);

/// The clearance level without memory. A clearance that is no number is stop.
[[nodiscard]] ClearanceLevel clearance_level(const MarginRule& rule, double clearance_mm) noexcept;

/// One cycle of one pair. Never a better level than clearance_level of the same clearance.
/// @param clearance_mm  certified lower bound
ClearanceLevel update_margin(MarginState& state, const MarginRule& rule,
                             double clearance_mm) noexcept;

}  // namespace axg
