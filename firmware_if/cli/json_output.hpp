// SPDX-License-Identifier: Apache-2.0
// --json[=FILE], the same for every command: one document, on stdout without FILE.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

namespace axg {

class Command;
struct CommandFiles;

struct JsonOutput {
    std::string target;                     // empty: none; "-": stdout; else a file
    std::shared_ptr<CommandFiles> files{};  // of the command; null: no other output

    [[nodiscard]] bool is_wanted() const noexcept { return !target.empty(); }
    /// Stream for a command's text: stderr while a result goes to stdout, else stdout.
    [[nodiscard]] std::FILE* words() const;
};

/// Adds --json. `output` must live as long as the parser. Only --json=FILE names a file: the word
/// after a bare --json remains a separate argument.
void add_json_option(const Command& command, JsonOutput& output);

/// Writes the text of a document if requested. False if it could not be written; the reason
/// is on stderr.
[[nodiscard]] bool write_json(const JsonOutput& output, const std::string& text);

}  // namespace axg
