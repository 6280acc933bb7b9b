// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/json_output.hpp"

#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/whole_file.hpp"

namespace axg {

void add_json_option(const Command& command, JsonOutput& output) {
    command.add_flag(
        "--json{-}", output.target,
        "write the results as one JSON document to stdout, or to FILE with --json=FILE");
    command.files()->outputs.push_back({"--json", &output.target});
    command.files()->json = &output.target;
    output.files = command.files();
}

std::FILE* JsonOutput::words() const {
    return files && takes_stdout(*files) ? stderr : stdout;
}

bool write_json(const JsonOutput& output, const std::string& text) {
    if (output.files) {
        output.files->has_document = true;
    }
    return !output.is_wanted() || write_whole_file(output.target, text, stderr);
}

}  // namespace axg
