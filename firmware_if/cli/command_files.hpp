// SPDX-License-Identifier: Apache-2.0
// The files that a command line names. An output that is an input too would destroy it, and one
// that cannot be written would waste the work before it: checks for both first.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace axg {

struct CommandFiles {
    struct Named {
        std::string option;
        const std::string* path;  // empty: not given
    };
    std::vector<Named> inputs, outputs, folders;
    const std::string* json = nullptr;  // target of --json; null: no such option
    bool has_document = false;          // it was written, or its writing failed
};

/// An input whose name has the ending of another kind of file: a program or a trace as MACHINE, a
/// machine file as PROGRAM or TRACE. Names both if they are swapped. Empty: none.
[[nodiscard]] std::string misplaced_input(const std::vector<CommandFiles::Named>& inputs);

/// Whether every output can be written and is no other file of the command. Prints faults on
/// `messages`.
[[nodiscard]] bool are_sound(const CommandFiles& files, std::FILE* messages);

/// Whether no output is one of these files, which the command turned out to read.
[[nodiscard]] bool are_apart(const CommandFiles& files, const std::vector<std::string>& inputs,
                             std::FILE* messages);

/// Whether one of the outputs is stdout: words for people belong on stderr then.
[[nodiscard]] bool takes_stdout(const CommandFiles& files);

}  // namespace axg
