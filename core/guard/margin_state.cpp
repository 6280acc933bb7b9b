// SPDX-License-Identifier: Apache-2.0
#include "core/guard/margin_state.hpp"

#include <algorithm>

namespace axg {

ClearanceLevel clearance_level(const MarginRule& rule, double clearance_mm) noexcept {
    // Each comparison is false for a NaN.
    return clearance_mm >= rule.warn_mm   ? ClearanceLevel::clear
           : clearance_mm >= rule.slow_mm ? ClearanceLevel::warn
           : clearance_mm >= rule.stop_mm ? ClearanceLevel::slow
                                          : ClearanceLevel::stop;
}

ClearanceLevel update_margin(MarginState& state, const MarginRule& rule,
                             double clearance_mm) noexcept {
    const ClearanceLevel now = clearance_level(rule, clearance_mm);
    const ClearanceLevel beyond_band = clearance_level(rule, clearance_mm - rule.band_mm);
    if (now < state.level) {
        state = {.level = now};
    } else if (beyond_band > state.level) {
        state.better = state.held_cycles == 0 ? beyond_band : std::min(state.better, beyond_band);
        if (++state.held_cycles >= rule.hold_cycles) {
            state = {.level = state.better};
        }
    } else {
        state.held_cycles = 0;
    }
    return state.level;
}

}  // namespace axg
