// SPDX-License-Identifier: Apache-2.0
// The CPU engine over a machine's surfaces, in the order core/pair_plan.hpp wants them.
#pragma once

#include <optional>

#include "core/cpu_engine.hpp"
#include "hil_replay/machine_options.hpp"

namespace axg {

/// Empty: this processor has no lane set, or memory ran out (kNoLaneSet says what to do).
[[nodiscard]] std::optional<CpuEngine> make_engine(const LoadedMachine& loaded);

}  // namespace axg
