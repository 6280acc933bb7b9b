// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/machine_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "config/cutting_parts.hpp"
#include "config/load_machine.hpp"
#include "config/quote_text.hpp"
#include "config/simplify_meshes.hpp"
#include "core/sincos.hpp"
#include "hil_replay/travel_proof.hpp"

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

/// Where the machine file asks for it.
void leave_out_what_is_never_near(LoadedMachine& loaded) {
    const Machine& machine = loaded.machine;
    std::vector<std::string>& notes = loaded.meshes.notes;
    if (!machine.guard.travel_proofs) {
        return;
    }
    const auto start = std::chrono::steady_clock::now();
    const auto kept = prove_travel(loaded);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    if (!kept) {
        notes.emplace_back("guard.travel_proofs: no engine runs here: nothing is left out");
        return;
    }
    std::uint64_t questions = 0;
    for (const KeptTriangles& of : *kept) {
        const Pair& pair = machine.pairs[of.pair];
        const std::string tool =
            of.tool == kNoIndex ? "" : fmt::format(" (tool {})", machine.tools[of.tool].number);
        const std::string what =
            of.is_apart ? "never that near: not asked about"
                        : fmt::format("{} of {} and {} of {} triangles may come that near",
                                      of.a.size(), of.whole_a, of.b.size(), of.whole_b);
        notes.push_back(
            fmt::format("travel: {}-{}{} within {} mm: {}", escaped(machine.bodies[pair.a].name),
                        escaped(machine.bodies[pair.b].name), tool, of.distance_mm, what));
        questions += of.questions;
    }
    notes.push_back(
        fmt::format("travel: {} questions in {:.1f} s, for the travel and {} mm, {:.3f} "
                    "degrees beyond",
                    questions, spent.count(), machine.guard.overrun_mm,
                    machine.guard.overrun_rad * (180 / kPi)));
    apply_travel(*kept, loaded);
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
        part_cutters(machine, meshes);
        mesh_faults = simplify_meshes(machine, meshes);
    }
    if (!mesh_faults.empty()) {
        print(mesh_faults, file, messages);
        return false;
    }
    out.machine = std::move(machine);
    out.meshes = std::move(meshes);
    leave_out_what_is_never_near(out);
    return true;
}

bool load(const MachineOptions& options, LoadedMachine& out, std::FILE* messages) {
    return load(options.file, options.mesh_root, out, messages);
}

}  // namespace axg
