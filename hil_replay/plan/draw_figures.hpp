// SPDX-License-Identifier: Apache-2.0
// Draws tables with a Python script (matplotlib) as a child process. The tables contain the whole
// figure, so that a user can draw it again, or differently, without this program.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace axg {

/// Values that captions state, by name.
using Conditions = std::vector<std::pair<std::string, std::string>>;

/// The text of conditions.csv.
[[nodiscard]] std::string conditions_table(const Conditions& conditions);

enum class Drawn { yes, not_installed, failed };

/// Runs hil_replay/SCRIPT of the installed data on the tables of `folder`. A figure gets its name
/// only when it is complete. Prints the package that is not installed, and all errors, to stderr.
[[nodiscard]] Drawn draw_figures(const std::string& script, const std::string& folder);

}  // namespace axg
