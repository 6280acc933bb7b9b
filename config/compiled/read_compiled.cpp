// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/compiled/byte_fields.hpp"
#include "config/compiled/compiled_machine.hpp"
#include "config/compiled/compiled_tags.hpp"
#include "config/machine/effective_text.hpp"
#include "config/machine/load_machine.hpp"
#include "config/machine/parse_machine.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/small_file.hpp"
#include "core/base/finite.hpp"
#include "core/certificate/pair_tasks.hpp"
#include "core/certificate/travel.hpp"
#include "core/collision/tree.hpp"

namespace axg {
namespace {

constexpr std::size_t kCompiledBytesMax = std::size_t{1} << 30U;

/// Reads one section after the other into `out`. Returns the fault of a section; empty: none.
class SectionReader {
  public:
    explicit SectionReader(CompiledMachine& out) noexcept : out_(out) {}

    std::string read(const SectionView& section) {
        if (section.tag == compiled::kText) {
            return read_text(section.payload);
        }
        if (section.tag == compiled::kNamed) {
            return read_named(section.payload);
        }
        if (section.tag == compiled::kHashes) {
            return read_hashes(section.payload);
        }
        if (section.tag == compiled::kNotes) {
            return read_notes(section.payload);
        }
        if (section.tag == compiled::kPairs) {
            return read_pairs(section.payload);
        }
        return section.tag == compiled::kMesh ? read_mesh(section.payload) : "an unknown section";
    }

    /// After the last section: checks that every surface of the machine is there.
    [[nodiscard]] std::string check_whole() const {
        if (!is_parsed_) {
            return "no machine file";
        }
        for (std::size_t i = 0; i < out_.machine.bodies.size(); ++i) {
            const Body& body = out_.machine.bodies[i];
            const bool has_own = body.has_mesh && !body.is_tool;
            if (has_own == out_.meshes.bodies[i].triangles.empty()) {
                return fmt::format("body {}: a missing or superfluous surface", escaped(body.name));
            }
        }
        for (std::size_t i = 0; i < out_.machine.tools.size(); ++i) {
            if (out_.meshes.tools[i].triangles.empty()) {
                return fmt::format("tool {}: a missing surface", out_.machine.tools[i].number);
            }
        }
        const auto& own = out_.meshes.of_pairs;
        const bool has_all = has_pairs_ && std::none_of(own.begin(), own.end(), [](const Mesh& m) {
                                 return m.triangles.empty();
                             });
        return has_all ? "" : "a missing surface of a pair";
    }

    /// Sums can be recomputed over other surfaces: the hash that board and guard compare has to
    /// match the surfaces that were read.
    [[nodiscard]] const char* check_hashes() const {
        const bool is_same = configuration_hash(out_.machine, out_.meshes) == whole_hash_ &&
                             configuration_hashes(out_.machine, out_.meshes).of == part_hashes_.of;
        return is_same ? "" : "surfaces that do not match the configuration hash";
    }

  private:
    static constexpr const char* kBadLengths = "inconsistent lengths";
    static constexpr const char* kBadOrder = "a section out of order";

    std::string read_text(std::string_view payload) {
        if (!out_.source.file.empty()) {
            return kBadOrder;
        }
        ByteReader in(payload);
        const std::string version = in.get_text();
        out_.source.file = in.get_text();
        out_.source.text = in.get_text();
        if (!in.is_at_end() || out_.source.file.empty()) {
            return kBadLengths;
        }
        return version == AXG_VERSION ? ""
                                      : fmt::format("a file of axguard {} (this is {})",
                                                    escaped(version), AXG_VERSION);
    }

    std::string read_named(std::string_view payload) {
        ByteReader in(payload);
        std::string name = in.get_text();
        std::string text = in.get_text();
        const bool is_new = out_.source.named.try_emplace(std::move(name), std::move(text)).second;
        return !in.is_at_end() ? kBadLengths : !is_new || is_parsed_ ? kBadOrder : "";
    }

    /// Parses the machine file; its effective text has to equal that of the compiling axguard.
    std::string read_hashes(std::string_view payload) {
        ByteReader in(payload);
        MachineMeshes& meshes = out_.meshes;
        const std::string text = in.get_text();
        whole_hash_ = in.get_text();
        part_hashes_.of = in.get<decltype(part_hashes_.of)>();
        if (!in.is_at_end() || out_.source.file.empty() || is_parsed_) {
            return !in.is_at_end() ? kBadLengths : kBadOrder;
        }
        const std::vector<ConfigFault> faults = parse_machine(out_.source, out_.machine);
        if (!faults.empty()) {
            return "a machine file that this axguard rejects: " + to_string(faults.front());
        }
        if (effective_text(out_.machine) != text) {
            return "a file compiled by an incompatible axguard version";
        }
        for (const Body& body : out_.machine.bodies) {
            meshes.bodies.push_back({body.name, {}});
        }
        for (const Tool& tool : out_.machine.tools) {
            meshes.tools.push_back({tool.name, {}});
        }
        meshes.simple_bodies = meshes.bodies;
        meshes.simple_tools = meshes.tools;
        is_parsed_ = true;
        return {};
    }

    std::string read_notes(std::string_view payload) {
        ByteReader in(payload);
        const auto count = in.get<std::uint32_t>();
        for (std::uint32_t i = 0; i < count && in.ok(); ++i) {
            out_.meshes.notes.push_back(in.get_text());
        }
        return in.is_at_end() ? "" : kBadLengths;
    }

    std::string read_pairs(std::string_view payload) {
        if (!is_parsed_ || has_pairs_) {
            return kBadOrder;
        }
        has_pairs_ = true;
        ByteReader in(payload);
        const auto surfaces = in.get<std::uint32_t>();
        Machine& machine = out_.machine;
        for (std::uint32_t left = in.get<std::uint32_t>(); left != 0 && in.ok(); --left) {
            PairSurface own;
            own.body = in.get<std::uint32_t>();
            own.against = in.get<std::uint32_t>();
            own.tool = in.get<std::uint32_t>();
            own.surface = in.get<std::uint32_t>();
            own.is_whole = in.get<std::uint8_t>() != 0;
            machine.pair_surfaces.push_back(own);
        }
        std::vector<TravelProof> proofs;
        for (std::uint32_t left = in.get<std::uint32_t>(); left != 0 && in.ok(); --left) {
            TravelProof proof;
            proof.distance_mm = in.get<double>();
            proof.is_apart = in.get<std::uint8_t>() != 0;
            proof.surface_a = in.get<std::uint32_t>();
            proof.surface_b = in.get<std::uint32_t>();
            proofs.push_back(proof);
        }
        if (!in.is_at_end() || surfaces > machine.pair_surfaces.size() + 2 * proofs.size()) {
            return kBadLengths;
        }
        if (!proofs.empty()) {
            machine.travel = travel_of(machine);
            machine.travel.proofs = std::move(proofs);
        }
        out_.meshes.of_pairs.resize(surfaces);
        return are_pairs_sound(machine, surfaces) ? "" : "an unknown surface of a pair";
    }

    static bool are_pairs_sound(const Machine& machine, std::uint32_t surfaces) {
        const auto is_own = [&machine, surfaces](const PairSurface& own) {
            return own.body < machine.bodies.size() && own.against < machine.bodies.size() &&
                   own.surface < surfaces &&
                   (own.tool < machine.tools.size() ||
                    (own.tool == kNoIndex && !machine.bodies[own.body].is_tool));
        };
        // Pruned surfaces follow the pair surfaces that they are parts of: none has a lower index.
        std::uint32_t own_last = 0;
        for (const PairSurface& own : machine.pair_surfaces) {
            own_last = std::max(own_last, own.surface);
        }
        const auto is_left = [surfaces, own_last](std::uint32_t index) {
            return index == kNoIndex || (index >= own_last && index < surfaces);
        };
        const std::vector<TravelProof>& proofs = machine.travel.proofs;
        return std::all_of(machine.pair_surfaces.begin(), machine.pair_surfaces.end(), is_own) &&
               (proofs.empty() ||
                (machine.guard.travel_proofs && proofs.size() == stop_tasks(machine))) &&
               std::all_of(proofs.begin(), proofs.end(), [&](const TravelProof& proof) {
                   return !std::isnan(proof.distance_mm) && is_left(proof.surface_a) &&
                          is_left(proof.surface_b);
               });
    }

    std::string read_mesh(std::string_view payload) {
        ByteReader in(payload);
        const auto list = in.get<std::uint32_t>();
        const auto index = in.get<std::uint32_t>();
        const auto deviation_mm = in.get<double>();
        if (!is_parsed_ || list >= compiled::kSurfaceLists) {
            return kBadOrder;
        }
        const bool is_tool = list % 2 == 1, is_own = list == 4, is_simple = list >= 2 && !is_own;
        MachineMeshes& meshes = out_.meshes;
        const std::array<std::vector<Mesh>*, compiled::kSurfaceLists> lists{
            &meshes.bodies, &meshes.tools, &meshes.simple_bodies, &meshes.simple_tools,
            &meshes.of_pairs};
        if (index >= lists[list]->size()) {
            return kBadOrder;
        }
        Mesh& mesh = (*lists[list])[index];
        MeshSource none;
        MeshSource& source = is_own    ? none
                             : is_tool ? out_.machine.tools[index].mesh
                                       : out_.machine.bodies[index].mesh;
        const auto named = [&mesh](const char* what) {
            return fmt::format("surface {}: {}", escaped(mesh.name), what);
        };
        if (!mesh.triangles.empty()) {
            return named("a second section of this kind");
        }
        if (is_simple ? !(deviation_mm > 0 && deviation_mm <= source.simplify_mm)
                      : deviation_mm != 0) {
            return named("a deviation above the limit of its machine file");
        }
        source.deviation_mm = is_simple ? deviation_mm : source.deviation_mm;
        const char* const fault = read_surface(in, mesh);
        return fault == nullptr ? "" : named(fault);
    }

    /// Null: the surface is whole.
    static const char* read_surface(ByteReader& in, Mesh& mesh) {
        const auto corners = in.get_array<Vec3f>();
        const auto indices = in.get_array<std::uint32_t>();
        const std::size_t count = indices.size() / 3;
        mesh.name = in.get_text();
        mesh.shape.nodes = in.get_array<std::uint8_t>();
        mesh.shape.triangles = in.get_items<std::uint32_t>(count);
        mesh.parts.parts = in.get_array<SurfacePart>();
        mesh.parts.is_closed = in.get_items<std::uint8_t>(count);
        if (!in.is_at_end() || count == 0 || count > kTrianglesMax || indices.size() % 3 != 0) {
            return kBadLengths;
        }
        if (std::any_of(indices.begin(), indices.end(),
                        [&corners](std::uint32_t index) { return index >= corners.size(); })) {
            return "a triangle with an unknown vertex";
        }
        mesh.triangles.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            mesh.triangles[i] = {corners[indices[3 * i]], corners[indices[3 * i + 1]],
                                 corners[indices[3 * i + 2]]};
        }
        if (!has_usable_triangles(mesh)) {
            return "a coordinate that is not finite, or out of range";
        }
        if (!is_sound(mesh.shape, count)) {
            return "a tree that does not contain each triangle once";
        }
        return are_sound(mesh.parts) ? nullptr : "invalid connected parts";
    }

    static bool are_sound(const SurfaceParts& parts) {
        const auto is_place = [](const Vec3f& p) {
            return is_finite(p.x) && is_finite(p.y) && is_finite(p.z) &&
                   std::fabs(p.x) <= kCoordinateMmMax && std::fabs(p.y) <= kCoordinateMmMax &&
                   std::fabs(p.z) <= kCoordinateMmMax;
        };
        return !parts.parts.empty() &&
               std::all_of(parts.parts.begin(), parts.parts.end(),
                           [&](const SurfacePart& part) {
                               return std::all_of(std::begin(part.extreme), std::end(part.extreme),
                                                  is_place);
                           }) &&
               std::all_of(parts.is_closed.begin(), parts.is_closed.end(),
                           [](std::uint8_t closed) { return closed <= 1; });
    }

    CompiledMachine& out_;
    std::string whole_hash_;  // as the file states them
    ConfigurationHashes part_hashes_;
    bool is_parsed_ = false, has_pairs_ = false;
};

std::string compile_again(const std::string& file, const std::string& source) {
    return fmt::format("an intact file of this axguard; run axguard compile {} -o {}",
                       source.empty() ? "MACHINE.yaml" : escaped(source, 4096),
                       escaped(file, 4096));
}

}  // namespace

bool is_compiled_name(std::string_view path) noexcept {
    return path.ends_with(".axg");
}

std::vector<ConfigFault> parse_compiled(std::string_view bytes, const std::string& file,
                                        CompiledMachine& out, Sums sums) {
    CompiledMachine read;
    std::vector<SectionView> sections;
    SectionFault fault = take_sections(bytes, sums, sections);
    SectionReader reader(read);
    if (!fault.got.empty() && !sections.empty()) {
        (void)reader.read(sections.front());  // what it was compiled from, for the message
    }
    for (std::size_t i = 0; i < sections.size() && fault.got.empty(); ++i) {
        fault = {std::string(escaped(sections[i].tag)), sections[i].at, reader.read(sections[i])};
    }
    if (fault.got.empty()) {
        fault = {"end", bytes.size(), reader.check_whole()};
    }
    if (fault.got.empty() && sums == Sums::checked) {
        fault = {"HASH", bytes.size(), reader.check_hashes()};
    }
    if (!fault.got.empty()) {
        return {{fmt::format("{}:{}", escaped(file, 4096), fault.at), "section " + fault.section,
                 fault.got, compile_again(file, read.source.file)}};
    }
    out = std::move(read);
    return {};
}

std::vector<ConfigFault> load_compiled(const std::string& path, CompiledMachine& out) {
    std::string bytes;
    const SmallFileFault fault = read_small_file(path, kCompiledBytesMax, bytes);
    if (!fault.wanted.empty()) {
        return {{escaped(path, 4096) + ":0", "", fault.got, fault.wanted}};
    }
    return parse_compiled(bytes, path, out);
}

std::vector<ConfigFault> load_machine(const std::string& path, Machine& out, MachineText* source) {
    CompiledMachine read;
    std::vector<ConfigFault> faults = is_compiled_name(path)
                                          ? load_compiled(path, read)
                                          : load_machine(path, read.machine, read.source);
    if (faults.empty()) {
        out = std::move(read.machine);
        if (source != nullptr) {
            *source = std::move(read.source);
        }
    }
    return faults;
}

}  // namespace axg
