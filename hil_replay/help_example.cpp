// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/help_example.hpp"

#include <CLI/CLI.hpp>

namespace axg {

void put_example_first(CLI::App& command, const std::string& example) {
    command.formatter_fn(
        [example](const CLI::App* app, const std::string& name, CLI::AppFormatMode mode) {
            return "Example:\n  " + example + "\n\n" + CLI::Formatter().make_help(app, name, mode);
        });
}

}  // namespace axg
