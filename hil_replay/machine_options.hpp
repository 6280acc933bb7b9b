// SPDX-License-Identifier: Apache-2.0
// MACHINE and --mesh-root, the same for every command that needs a machine.
#pragma once

#include <cstdio>
#include <string>

#include "config/compiled_machine.hpp"

namespace axg {

class Command;

struct MachineOptions {
    std::string file;
    std::string mesh_root;  // empty: the machine file's folder
};

/// Adds the positional MACHINE and --mesh-root. `options` must live as long as the parser.
void add_machine_options(const Command& command, MachineOptions& options);

/// Where it was compiled `source` says what from.
using LoadedMachine = CompiledMachine;

/// Reads the machine file, then the meshes it names; or a compiled machine, which needs no other
/// file. False after faults: all of them are on `messages`, one a line, with the number of them
/// behind; `out` is untouched.
[[nodiscard]] bool load(const std::string& file, const std::string& mesh_root, LoadedMachine& out,
                        std::FILE* messages);
[[nodiscard]] bool load(const MachineOptions& options, LoadedMachine& out, std::FILE* messages);

}  // namespace axg
