// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/cli/machine_options.hpp"

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "config/machine/load_machine.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_files.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/progress.hpp"

namespace axg {
namespace {

/// Every file that was read for a machine, in addition to the machine file.
std::vector<std::string> files_of(const MachineOptions& options, const Machine& machine,
                                  const MachineText& source) {
    namespace fs = std::filesystem;
    std::vector<std::string> files;
    if (is_compiled_name(options.file)) {
        return files;
    }
    const fs::path folder = fs::path(options.file).parent_path();
    for (const auto& [name, text] : source.named) {
        files.push_back((folder / name).string());
    }
    const fs::path root = options.mesh_root.empty() ? folder : fs::path(options.mesh_root);
    const auto add = [&](const MeshSource& mesh) {
        if (!mesh.file.empty()) {
            files.push_back((root / mesh.file).string());
        }
    };
    for (const Body& body : machine.bodies) {
        add(body.mesh);
    }
    for (const Tool& tool : machine.tools) {
        add(tool.mesh);
    }
    return files;
}

int exit_code_of(const MachineOptions& options, const Machine& machine, const MachineText& source) {
    const bool is_sound =
        !options.files || are_apart(*options.files, files_of(options, machine, source), stderr);
    return is_sound ? kExitClean : kExitUsage;
}

void print(const std::vector<std::string>& doubts) {
    for (const std::string& doubt : doubts) {
        std::fprintf(stderr, "to review: %s\n", doubt.c_str());
    }
}

}  // namespace

void add_machine_options(const Command& command, MachineOptions& options) {
    options.files = command.files();
    command
        .add_input(
            "MACHINE", options.file,
            "machine file (YAML, docs/reference/machine-file.md), or compiled machine (.axg)")
        .required();
    command.add_option(
        "--mesh-root", options.mesh_root,
        "folder that mesh file names are relative to [default: folder of the machine file]");
}

int load(const MachineOptions& options, LoadedMachine& out) {
    Progress progress;
    const bool is_loaded =
        load(options.file, options.mesh_root, out, stderr, [&progress](double share) {
            if (progress.is_due()) {
                progress.show(share, "proving never-colliding sets");
            }
        });
    if (!is_loaded) {
        return kExitInput;
    }
    if (!options.lists_doubts) {
        print(out.source.doubts);
        print(out.doubts);
    }
    return exit_code_of(options, out.machine, out.source);
}

int load_without_meshes(const MachineOptions& options, Machine& out, MachineText& source) {
    const std::vector<ConfigFault> faults = load_machine(options.file, out, &source);
    for (const ConfigFault& fault : faults) {
        std::fprintf(stderr, "%s\n", to_string(fault).c_str());
    }
    // The faults of a compiled machine already end with the command that corrects them.
    if (!faults.empty() && !is_compiled_name(options.file)) {
        std::fprintf(stderr, "%s", fault_summary(options.file, faults.size()).c_str());
    }
    if (!faults.empty()) {
        return kExitInput;
    }
    print(source.doubts);
    return exit_code_of(options, out, source);
}

}  // namespace axg
