// SPDX-License-Identifier: Apache-2.0
// Exit code of a program whose guard has stopped (the live guard and the replay of its black box),
// or whose engine may not run.
#pragma once

#include "core/guard/guard_state.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/choose_engine.hpp"

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

[[nodiscard]] constexpr ExitCode exit_code_of(EngineRefusal refusal) noexcept {
    switch (refusal) {
        case EngineRefusal::none:
            return kExitClean;
        case EngineRefusal::no_gpu:
            return kExitGpu;
        default:
            return kExitUnfit;
    }
}

}  // namespace axg
