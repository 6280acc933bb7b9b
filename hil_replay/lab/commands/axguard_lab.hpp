// SPDX-License-Identifier: Apache-2.0
// axguard-lab as a function: the command line in, the exit code out.
#pragma once

#include <string>
#include <vector>

namespace axg {

/// @param words  as typed after the program's name
[[nodiscard]] int run_axguard_lab(std::vector<std::string> words);

}  // namespace axg
