// SPDX-License-Identifier: Apache-2.0
// Commands that moved to axguard-lab start it, for one release.
#pragma once

#include <string>
#include <vector>

namespace axg {

/// Replaces this process by axguard-lab, with the same words, after one line on stderr.
/// @return  kExitInput, when it cannot be started
[[nodiscard]] int start_lab(const std::vector<std::string>& words);

}  // namespace axg
