// SPDX-License-Identifier: Apache-2.0
// One promise about the motion of an axis that its positions show broken. Pure data.
#pragma once

#include <cstdint>

#include "core/machine/machine.hpp"

namespace axg {

enum class LimitKind : std::uint8_t {
    none = 0,
    speed,
    acceleration,
    jerk,
    speed_range,         // bounds of the speed contradict each other
    acceleration_range,  // bounds of the acceleration contradict each other
    frozen_axis,         // its count rests though no motion within the limits could stop there
    stopping,            // a stop harder than its drive can brake: stopping_most_...
    left_reach,          // outside the reach of the last permit: a stop too late or too soft
};
[[nodiscard]] const char* to_text(LimitKind kind) noexcept;

/// One broken limit.
struct LimitFact {
    LimitKind kind = LimitKind::none;
    std::uint32_t axis = kNoIndex;
    double measured = 0;  // the least value that explains the positions; for a range, the gap; for
                          // a frozen axis, the least speed before; for
                          // left_reach, the distance outside
    double declared = 0;  // by the machine file; 0 for a range, a frozen axis or left_reach
    std::uint64_t sample = 0;
};

}  // namespace axg
