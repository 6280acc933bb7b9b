// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/loaded_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "config/machine/load_machine.hpp"
#include "config/mesh/cutting_parts.hpp"
#include "config/mesh/drawing_doubts.hpp"
#include "config/mesh/simplify_meshes.hpp"
#include "config/mesh/size_doubts.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/setup/pose_errors.hpp"
#include "firmware_if/setup/travel_proof.hpp"

namespace axg {
namespace {

void print(const std::vector<ConfigFault>& faults, const std::string& file, std::FILE* messages) {
    for (const ConfigFault& fault : faults) {
        std::fprintf(messages, "%s\n", to_string(fault).c_str());
    }
    std::fprintf(messages, "%s", fault_summary(file, faults.size()).c_str());
}

/// No effect unless the machine file sets guard.travel_proofs.
void prune_never_colliding(LoadedMachine& loaded, const LoadProgress& progress) {
    const Machine& machine = loaded.machine;
    std::vector<std::string>& notes = loaded.meshes.notes;
    if (!machine.guard.travel_proofs) {
        return;
    }
    const auto kept = prove_travel(
        loaded, {}, progress ? progress : [](double) {});
    if (!kept) {
        notes.emplace_back("guard.travel_proofs: no engine on this host; no pair is pruned");
        return;
    }
    std::uint64_t queries = 0;
    for (const KeptTriangles& of : *kept) {
        const Pair& pair = machine.pairs[of.pair];
        const std::string tool =
            of.tool == kNoIndex ? "" : fmt::format(" (tool {})", machine.tools[of.tool].number);
        const std::string what =
            of.is_apart
                ? "never within that distance: not queried"
                : fmt::format("{} of {} and {} of {} triangles may come within that distance",
                              of.a.size(), of.whole_a, of.b.size(), of.whole_b);
        notes.push_back(fmt::format(
            "travel: {}-{}{} within {:.6g} mm: {}", escaped(machine.bodies[pair.a].name),
            escaped(machine.bodies[pair.b].name), tool, of.distance_mm, what));
        queries += of.queries;
    }
    notes.push_back(fmt::format(
        "travel: {} queries, for the travel and an overrun of {:.6g} mm, {:.6g} degrees", queries,
        machine.guard.overrun_mm, machine.guard.overrun_rad * (180 / kPi)));
    apply_travel(*kept, loaded);
}

}  // namespace

std::string fault_summary(const std::string& file, std::size_t faults) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        return {};  // there is nothing to repair
    }
    const std::string name = escaped(file, 4096);
    return fmt::format("{}: {}{} {}. Correct the file and run axguard check {} again.\n", name,
                       faults > kFaultsShownMax ? "more than " : "",
                       std::min(faults, kFaultsShownMax), faults == 1 ? "fault" : "faults", name);
}

bool load(const std::string& file, const std::string& mesh_root, LoadedMachine& out,
          std::FILE* messages, const LoadProgress& progress) {
    if (is_compiled_name(file)) {
        if (!mesh_root.empty()) {
            std::fprintf(messages, "--mesh-root: %s contains its surfaces. Leave the option out.\n",
                         escaped(file, 4096).c_str());
            return false;
        }
        const std::vector<ConfigFault> faults = load_compiled(file, out);
        for (const ConfigFault& fault : faults) {
            std::fprintf(messages, "%s\n", to_string(fault).c_str());
        }
        if (faults.empty()) {
            out.machine.pose_errors = find_pose_errors(out.machine, out.meshes);
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
        faults = doubt_sizes(read.machine, read.meshes);
    }
    if (faults.empty()) {
        read.doubts = doubt_drawings(read.machine, read.meshes);
        part_cutters(read.machine, read.meshes);
        faults = simplify_meshes(read.machine, read.meshes);
    }
    if (faults.empty()) {
        read.machine.pose_errors = find_pose_errors(read.machine, read.meshes);
        faults = pose_error_faults(read);
    }
    if (!faults.empty()) {
        print(faults, file, messages);
        return false;
    }
    out = std::move(read);
    prune_never_colliding(out, progress);
    return true;
}

}  // namespace axg
