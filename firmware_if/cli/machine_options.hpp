// SPDX-License-Identifier: Apache-2.0
// MACHINE and --mesh-root, the same for every command that needs a machine.
#pragma once

#include <memory>
#include <string>

#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

class Command;
struct CommandFiles;

struct MachineOptions {
    std::string file;
    std::string mesh_root;                        // empty: the machine file's folder
    std::shared_ptr<const CommandFiles> files{};  // of the command
    bool lists_doubts = false;                    // by the command itself
};

/// Adds the positional MACHINE and --mesh-root. `options` must live as long as the parser.
void add_machine_options(const Command& command, MachineOptions& options);

/// As load() of setup/loaded_machine.hpp. Faults go to stderr; so do doubts that the command does
/// not list, and a line of progress on a terminal while travel proofs are made.
/// @return  kExitClean, or the exit code of what was wrong: kExitUsage where an output of the
///          command is a file of the machine
[[nodiscard]] int load(const MachineOptions& options, LoadedMachine& out);
/// The same without surfaces, for what needs none of them.
/// @param source  out: the text of the machine file
[[nodiscard]] int load_without_meshes(const MachineOptions& options, Machine& out,
                                      MachineText& source);

}  // namespace axg
