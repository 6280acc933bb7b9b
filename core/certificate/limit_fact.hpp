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
    acceleration_range,  // and those of the acceleration
    frozen_axis,         // its count stays where no motion within the limits could hold it
    stopping,            // a stop harder than any of its drive: stopping_most_...
};
[[nodiscard]] const char* to_text(LimitKind kind) noexcept;

/// One limit that was broken.
struct LimitFact {
    LimitKind kind = LimitKind::none;
    std::uint32_t axis = kNoIndex;
    double measured = 0;  // the least value that explains the positions; of a range, the gap; of a
                          // frozen axis, the least speed before
    double declared = 0;  // by the machine file; of a range, or a frozen axis, 0
    std::uint64_t sample = 0;
};

}  // namespace axg
