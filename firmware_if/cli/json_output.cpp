// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/json_output.hpp"

#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/whole_file.hpp"

namespace axg {

void add_json_option(const Command& command, JsonOutput& output) {
    command.add_flag("--json{-}", output.target,
                     "Write the results as one JSON document, to stdout or with --json=FILE there");
}

bool write_json(const JsonOutput& output, const std::string& text) {
    if (!output.is_wanted()) {
        return true;
    }
    if (output.target != "-") {
        return write_whole_file(output.target, text, stderr);
    }
    const bool sound = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    return std::fflush(stdout) == 0 && sound;
}

}  // namespace axg
