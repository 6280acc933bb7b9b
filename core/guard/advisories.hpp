// SPDX-License-Identifier: Apache-2.0
// Contents of a permit in addition to permit or stop. Advisories: no permit and no proof depends
// on them. Source: docs/reference/states.md, "Advisories".
#pragma once

#include <cstdint>

#include "core/guard/margin_state.hpp"
#include "core/machine/machine.hpp"

namespace axg {

inline constexpr std::uint32_t kSpeedCapRapid = 250;  // the permit's unit: 1/250 of rapid

struct Advisories {
    std::uint8_t speed_cap = kSpeedCapRapid;                 // 1/250 of rapid
    ClearanceLevel clearance_level = ClearanceLevel::clear;  // of the pair whose level is worst
    std::uint32_t pair = kNoIndex;  // Machine::pairs, which; kNoIndex: all are clear
    double distance_mm = 0;         // certified distance of that pair
};

}  // namespace axg
