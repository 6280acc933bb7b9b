// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>
#include <map>
#include <utility>

#include "config/compiled/byte_fields.hpp"
#include "config/compiled/compiled_machine.hpp"
#include "config/compiled/compiled_tags.hpp"
#include "config/machine/effective_text.hpp"
#include "core/collision/tree.hpp"
#include "core/mesh/surface_parts.hpp"

namespace axg {
namespace {

using compiled::SurfaceList;

std::string text_payload(const MachineText& source) {
    ByteWriter out;
    out.put_text(AXG_VERSION);
    out.put_text(source.file);
    out.put_text(source.text);
    return std::move(out.bytes);
}

std::string named_payload(const std::string& name, const std::string& text) {
    ByteWriter out;
    out.put_text(name);
    out.put_text(text);
    return std::move(out.bytes);
}

std::string hashes_payload(const CompiledMachine& compiled) {
    ByteWriter out;
    out.put_text(effective_text(compiled.machine));
    out.put_text(configuration_hash(compiled.machine, compiled.meshes));
    out.put(configuration_hashes(compiled.machine, compiled.meshes).of);
    return std::move(out.bytes);
}

std::string notes_payload(const std::vector<std::string>& notes) {
    ByteWriter out;
    out.put(static_cast<std::uint32_t>(notes.size()));
    for (const std::string& note : notes) {
        out.put_text(note);
    }
    return std::move(out.bytes);
}

std::string pairs_payload(const Machine& machine, std::size_t surface_count) {
    ByteWriter out;
    out.put(static_cast<std::uint32_t>(surface_count));
    out.put(static_cast<std::uint32_t>(machine.pair_surfaces.size()));
    for (const PairSurface& own : machine.pair_surfaces) {
        out.put(own.body);
        out.put(own.against);
        out.put(own.tool);
        out.put(own.surface);
        out.put(static_cast<std::uint8_t>(own.is_whole));
    }
    out.put(static_cast<std::uint32_t>(machine.travel.proofs.size()));
    for (const TravelProof& proof : machine.travel.proofs) {
        out.put(proof.distance_mm);
        out.put(static_cast<std::uint8_t>(proof.is_apart));
        out.put(proof.surface_a);
        out.put(proof.surface_b);
    }
    return std::move(out.bytes);
}

/// Corners in the order in which triangles first use them; equal are those of equal bits.
void put_triangles(ByteWriter& out, const std::vector<Triangle>& triangles) {
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> places;
    std::vector<Vec3f> corners;
    std::vector<std::uint32_t> indices;
    for (const Triangle& triangle : triangles) {
        for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) {
            const auto bits = std::bit_cast<std::array<std::uint32_t, 3>>(corner);
            const auto [place, is_new] =
                places.try_emplace(bits, static_cast<std::uint32_t>(corners.size()));
            if (is_new) {
                corners.push_back(corner);
            }
            indices.push_back(place->second);
        }
    }
    out.put_array(corners);
    out.put_array(indices);
}

std::string mesh_payload(SurfaceList list, std::size_t index, const Mesh& mesh,
                         double deviation_mm) {
    ByteWriter out;
    out.put(static_cast<std::uint32_t>(list));
    out.put(static_cast<std::uint32_t>(index));
    out.put(deviation_mm);
    put_triangles(out, mesh.triangles);
    out.put_text(mesh.name);
    const TreeShape shape = shape_of(mesh);
    out.put_array(shape.nodes);
    out.put_items(std::span<const std::uint32_t>(shape.triangles));
    const SurfaceParts parts = parts_of(mesh);
    out.put_array(parts.parts);
    out.put_items(std::span<const std::uint8_t>(parts.is_closed));
    return std::move(out.bytes);
}

}  // namespace

std::string compile_machine(const CompiledMachine& compiled) {
    std::vector<CompiledSection> sections;
    sections.push_back({compiled::kText, text_payload(compiled.source)});
    for (const auto& [name, text] : compiled.source.named) {
        sections.push_back({compiled::kNamed, named_payload(name, text)});
    }
    sections.push_back({compiled::kHashes, hashes_payload(compiled)});
    // By name, so that a member that is added cannot be forgotten here: this line would not
    // compile.
    const auto& [bodies, tools, simple_bodies, simple_tools, of_pairs, notes] = compiled.meshes;
    sections.push_back({compiled::kNotes, notes_payload(notes)});
    sections.push_back({compiled::kPairs, pairs_payload(compiled.machine, of_pairs.size())});
    const auto put_all = [&sections](SurfaceList list, const std::vector<Mesh>& surfaces,
                                     auto&& deviation_mm) {
        for (std::size_t i = 0; i < surfaces.size(); ++i) {
            if (!surfaces[i].triangles.empty()) {
                sections.push_back(
                    {compiled::kMesh, mesh_payload(list, i, surfaces[i], deviation_mm(i))});
            }
        }
    };
    const auto none = [](std::size_t) { return 0.0; };
    put_all(SurfaceList::bodies, bodies, none);
    put_all(SurfaceList::tools, tools, none);
    put_all(SurfaceList::simple_bodies, simple_bodies,
            [&](std::size_t i) { return compiled.machine.bodies[i].mesh.deviation_mm; });
    put_all(SurfaceList::simple_tools, simple_tools,
            [&](std::size_t i) { return compiled.machine.tools[i].mesh.deviation_mm; });
    put_all(SurfaceList::of_pairs, of_pairs, none);
    return put_sections(sections);
}

}  // namespace axg
