// SPDX-License-Identifier: Apache-2.0
// The certified test of core/ as methods of the laboratory: only its first stage
// (certified-shared-f32), in float, and with the recheck in double.
#pragma once

#include <vector>

#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

/// Adds them if this processor has the widest set of lanes of this build.
void add_certified(std::vector<Method>& methods);

}  // namespace axg::lab
