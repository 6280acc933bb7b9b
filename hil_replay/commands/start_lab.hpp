// SPDX-License-Identifier: Apache-2.0
// Commands that moved to axguard-lab start it, for one release.
#pragma once

#include <string>
#include <vector>

namespace axg {

/// Becomes the axguard-lab beside this program, with the same words; one line on stderr says so.
/// @return  kExitInput, when it cannot be started
[[nodiscard]] int start_lab(const std::vector<std::string>& words);

}  // namespace axg
