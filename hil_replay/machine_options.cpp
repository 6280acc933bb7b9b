// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/machine_options.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "config/cutting_parts.hpp"
#include "config/load_machine.hpp"
#include "config/quote_text.hpp"
#include "config/simplify_meshes.hpp"
#include "core/sincos.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/progress.hpp"
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
/// @param shows_progress  on the terminal; not in the process of somebody else
void leave_out_what_is_never_near(LoadedMachine& loaded, bool shows_progress) {
    const Machine& machine = loaded.machine;
    std::vector<std::string>& notes = loaded.meshes.notes;
    if (!machine.guard.travel_proofs) {
        return;
    }
    Progress progress;
    const auto kept = prove_travel(loaded, {}, [&](double share) {
        if (shows_progress && progress.is_due()) {
            progress.show(share, "proving what never comes near");
        }
    });
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
        notes.push_back(fmt::format(
            "travel: {}-{}{} within {:.6g} mm: {}", escaped(machine.bodies[pair.a].name),
            escaped(machine.bodies[pair.b].name), tool, of.distance_mm, what));
        questions += of.questions;
    }
    notes.push_back(
        fmt::format("travel: {} questions, for the travel and {:.6g} mm, {:.6g} degrees beyond",
                    questions, machine.guard.overrun_mm, machine.guard.overrun_rad * (180 / kPi)));
    apply_travel(*kept, loaded);
}

}  // namespace

void add_machine_options(const Command& command, MachineOptions& options) {
    command
        .add_option("MACHINE", options.file,
                    "Machine file (YAML, docs/machine-file.md), or compiled (.axg)")
        .required();
    command.add_option("--mesh-root", options.mesh_root,
                       "Folder that the machine file's meshes are named from (default: its own)");
}

bool load(const std::string& file, const std::string& mesh_root, LoadedMachine& out,
          std::FILE* messages) {
    if (is_compiled_name(file)) {
        if (!mesh_root.empty()) {
            std::fprintf(messages, "--mesh-root: %s holds its surfaces; leave the option out\n",
                         escaped(file, 4096).c_str());
            return false;
        }
        const std::vector<ConfigFault> faults = load_compiled(file, out);
        for (const ConfigFault& fault : faults) {
            std::fprintf(messages, "%s\n", to_string(fault).c_str());
        }
        return faults.empty();
    }
    LoadedMachine read;
    std::vector<ConfigFault> faults = load_machine(file, read.machine, read.source);
    if (faults.empty()) {
        const std::string root =
            mesh_root.empty() ? std::filesystem::path(file).parent_path().string() : mesh_root;
        faults = load_meshes(read.machine, root, read.meshes);
    }
    if (faults.empty()) {
        part_cutters(read.machine, read.meshes);
        faults = simplify_meshes(read.machine, read.meshes);
    }
    if (!faults.empty()) {
        print(faults, file, messages);
        return false;
    }
    out = std::move(read);
    leave_out_what_is_never_near(out, messages == stderr);
    return true;
}

bool load(const MachineOptions& options, LoadedMachine& out, std::FILE* messages) {
    return load(options.file, options.mesh_root, out, messages);
}

}  // namespace axg
