// SPDX-License-Identifier: Apache-2.0
// Scripts with which a shell completes the commands and options of a program.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

struct CompletedOption {
    std::vector<std::string> names;  // "-o", "--output"
    std::string help;
    std::vector<std::string> words;  // all its values; empty: others, such as file names
    bool has_value = false;
};

struct CompletedCommand {
    std::string name, purpose;
    std::vector<CompletedOption> options;
    std::vector<std::string> words;  // that it accepts in the place of file names
};

/// @param shell  bash, zsh or fish
[[nodiscard]] std::string completion_script(std::string_view shell, const std::string& program,
                                            std::span<const CompletedCommand> commands);

}  // namespace axg
