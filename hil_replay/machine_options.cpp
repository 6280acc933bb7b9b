// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/machine_options.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "config/load_machine.hpp"
#include "config/quote_text.hpp"
#include "config/simplify_meshes.hpp"

namespace axg {
namespace {

void print(const std::vector<ConfigFault>& faults, const std::string& file, std::FILE* messages) {
    for (const ConfigFault& fault : faults) {
        std::fprintf(messages, "%s\n", to_string(fault).c_str());
    }
    std::fprintf(messages, "%s: %zu %s; repair the file and try again: axguard check %s\n",
                 escaped(file, 4096).c_str(), faults.size(),
                 faults.size() == 1 ? "fault" : "faults", escaped(file, 4096).c_str());
}

}  // namespace

void add_machine_options(CLI::App& command, MachineOptions& options) {
    command.add_option("MACHINE", options.file, "Machine file (YAML, docs/machine-file.md)")
        ->required();
    command.add_option("--mesh-root", options.mesh_root,
                       "Folder that the machine file's meshes are named from (default: its own)");
}

bool load(const std::string& file, const std::string& mesh_root, LoadedMachine& out,
          std::FILE* messages) {
    Machine machine;
    const std::vector<ConfigFault> faults = load_machine(file, machine);
    if (!faults.empty()) {
        print(faults, file, messages);
        return false;
    }
    const std::string root =
        mesh_root.empty() ? std::filesystem::path(file).parent_path().string() : mesh_root;
    MachineMeshes meshes;
    std::vector<ConfigFault> mesh_faults = load_meshes(machine, root, meshes);
    if (mesh_faults.empty()) {
        mesh_faults = simplify_meshes(machine, meshes);
    }
    if (!mesh_faults.empty()) {
        print(mesh_faults, file, messages);
        return false;
    }
    out.machine = std::move(machine);
    out.meshes = std::move(meshes);
    return true;
}

bool load(const MachineOptions& options, LoadedMachine& out, std::FILE* messages) {
    return load(options.file, options.mesh_root, out, messages);
}

}  // namespace axg
