// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/surface_list.hpp"

#include "core/base/assert.hpp"
#include "core/base/limits.hpp"
#include "core/certificate/pair_queries.hpp"
#include "core/certificate/travel.hpp"
#include "core/collision/known_answer.hpp"

namespace axg {
namespace {

/// Adds each surface, simplified where such a version exists, and the whole one.
void add(const std::vector<Mesh>& whole, const std::vector<Mesh>& simple, SurfaceList& out) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const bool is_simple = i < simple.size() && !simple[i].triangles.empty();
        out.same_as.push_back(static_cast<std::uint32_t>(out.engines.size()));
        out.engines.push_back(is_simple ? &simple[i] : &whole[i]);
        out.whole.push_back(&whole[i]);
    }
}

/// Marks a pruned surface as a part of the body that its whole surface belongs to.
void mark_whole(const Machine& machine, std::uint32_t surface, std::uint32_t body,
                std::uint32_t against, std::uint32_t tool, SurfaceList& out) {
    if (surface != kNoIndex) {
        out.same_as[pair_mesh_index(machine, surface)] =
            out.same_as[mesh_in_pair(machine, body, against, tool)];
    }
}

/// Marks the body of each surface of a pair that is only a part of a body.
void mark_bodies(const Machine& machine, SurfaceList& out) {
    for (const PairSurface& own : machine.pair_surfaces) {
        const std::uint32_t place = pair_mesh_index(machine, own.surface);
        AXG_ASSERT(place < out.engines.size());
        if (!own.is_whole) {
            const bool is_tool = machine.bodies[own.body].is_tool;
            out.same_as[place] = is_tool ? tool_mesh_index(machine, own.tool) : own.body;
        }
    }
    std::size_t place = 0;
    for (const Pair& pair : machine.pairs) {
        for (std::uint32_t k = 0; k < tasks_of(machine, pair); ++k, ++place) {
            const TravelProof proof = travel_proof(machine, static_cast<std::uint32_t>(place));
            mark_whole(machine, proof.surface_a, pair.a, pair.b, k, out);
            mark_whole(machine, proof.surface_b, pair.b, pair.a, k, out);
        }
    }
}

}  // namespace

SurfaceList surface_list(const LoadedMachine& loaded) {
    static const std::vector<Mesh> known_answer{known_answer_mesh()};
    const MachineMeshes& meshes = loaded.meshes;
    SurfaceList out;
    out.body_count = meshes.bodies.size();
    out.tool_count = meshes.tools.size();
    AXG_ASSERT(out.body_count + out.tool_count <= kMeshesMax);
    add(meshes.bodies, meshes.simple_bodies, out);
    add(meshes.tools, meshes.simple_tools, out);
    add(known_answer, {}, out);
    add(meshes.of_pairs, {}, out);
    mark_bodies(loaded.machine, out);
    for (std::size_t i = 0; i < out.engines.size(); ++i) {
        const bool is_simple = out.engines[i] != out.whole[i];
        const std::size_t place = is_simple ? out.engines.size() + out.behind.size() : i;
        out.whole_tree.push_back(static_cast<std::uint32_t>(place));
        if (is_simple) {
            out.behind.push_back(out.whole[i]);
        }
    }
    return out;
}

}  // namespace axg
