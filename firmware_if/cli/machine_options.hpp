// SPDX-License-Identifier: Apache-2.0
// MACHINE and --mesh-root, the same for every command that needs a machine.
#pragma once

#include <string>

#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

class Command;

struct MachineOptions {
    std::string file;
    std::string mesh_root;  // empty: the machine file's folder
};

/// Adds the positional MACHINE and --mesh-root. `options` must live as long as the parser.
void add_machine_options(const Command& command, MachineOptions& options);

/// As load() of setup/loaded_machine.hpp. Faults go to stderr; so does a line of progress on a
/// terminal while travel proofs are made.
[[nodiscard]] bool load(const MachineOptions& options, LoadedMachine& out);

}  // namespace axg
