// SPDX-License-Identifier: Apache-2.0
// axguard as a function: the command line in, the exit code out. The demo types its commands
// through it.
#pragma once

#include <string>
#include <vector>

namespace axg {

/// @param words  as typed after the program's name
[[nodiscard]] int run_axguard(std::vector<std::string> words);

}  // namespace axg
