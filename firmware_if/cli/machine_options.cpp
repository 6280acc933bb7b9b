// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/machine_options.hpp"

#include <cstdio>

#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/progress.hpp"

namespace axg {

void add_machine_options(const Command& command, MachineOptions& options) {
    command
        .add_option("MACHINE", options.file,
                    "Machine file (YAML, docs/machine-file.md), or compiled (.axg)")
        .required();
    command.add_option("--mesh-root", options.mesh_root,
                       "Folder that the machine file's meshes are named from (default: its own)");
}

bool load(const MachineOptions& options, LoadedMachine& out) {
    Progress progress;
    return load(options.file, options.mesh_root, out, stderr, [&progress](double share) {
        if (progress.is_due()) {
            progress.show(share, "proving what never comes near");
        }
    });
}

}  // namespace axg
