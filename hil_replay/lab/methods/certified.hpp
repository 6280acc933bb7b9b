// SPDX-License-Identifier: Apache-2.0
// The certified test of core/ as methods of the laboratory: its first stage alone
// (certified-shared-f32), in float, and with the recheck in double.
#pragma once

#include <vector>

#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

/// Adds them where this processor has the lanes they are written for.
void add_certified(std::vector<Method>& methods);

}  // namespace axg::lab
