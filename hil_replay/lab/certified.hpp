// SPDX-License-Identifier: Apache-2.0
// The certified test of core/ as methods of the laboratory: certified-f32 and certified-f32+f64.
#pragma once

#include <vector>

#include "hil_replay/lab/method.hpp"

namespace axg::lab {

/// Adds them where this processor has the lanes they are written for.
void add_certified(std::vector<Method>& methods);

}  // namespace axg::lab
