// SPDX-License-Identifier: Apache-2.0
// What a program ends with whose guard has stopped: the live guard, and the replay of its black
// box.
#pragma once

#include "core/guard_state.hpp"
#include "firmware_if/cli/exit_codes.hpp"

namespace axg {

[[nodiscard]] constexpr ExitCode exit_code_of(GuardFault cause) noexcept {
    switch (cause) {
        case GuardFault::verdict:
        case GuardFault::latched:
            return kExitCollision;
        case GuardFault::engine:
        case GuardFault::gap:
        case GuardFault::silence:
        case GuardFault::flapping:
            return kExitDeadline;
        case GuardFault::refused:
            return kExitUnfit;
        default:
            return kExitCan;
    }
}

}  // namespace axg
