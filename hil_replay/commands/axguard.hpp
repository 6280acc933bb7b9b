// SPDX-License-Identifier: Apache-2.0
// axguard as a function: the command line in, the exit code out. The demo runs its commands through
// it.
#pragma once

#include <string>
#include <vector>

#include "hil_replay/commands/commands.hpp"

namespace axg {

/// @param words     as typed after the program's name
/// @param observer  called with the result of a replay, before its files are written
[[nodiscard]] int run_axguard(std::vector<std::string> words, const ReplayObserver& observer = {});

}  // namespace axg
