// SPDX-License-Identifier: Apache-2.0
// The exact judge as a method of the laboratory. Only in builds with GMP: AXG_EXACT.
#pragma once

#include <vector>

#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

void add_exact(std::vector<Method>& methods);

}  // namespace axg::lab
