// SPDX-License-Identifier: Apache-2.0
#include "core/reach/limit_fact.hpp"

namespace axg {

const char* to_text(LimitKind kind) noexcept {
    switch (kind) {
        case LimitKind::none:
            return "none";
        case LimitKind::speed:
            return "speed";
        case LimitKind::acceleration:
            return "acceleration";
        case LimitKind::jerk:
            return "jerk";
        case LimitKind::speed_range:
            return "speed_range";
        case LimitKind::acceleration_range:
            return "acceleration_range";
        case LimitKind::frozen_axis:
            return "frozen_axis";
        case LimitKind::stopping:
            return "stopping";
        case LimitKind::left_reach:
            return "left_reach";
    }
    return "none";
}

}  // namespace axg
