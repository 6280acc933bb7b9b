// SPDX-License-Identifier: Apache-2.0
// A command's help starts with an example that works: most people read no further.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace axg {

/// Puts `example` in front of the command's help; the list of commands keeps its one line.
void put_example_first(CLI::App& command, const std::string& example);

}  // namespace axg
