// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/body_triangles.hpp"

#include <array>
#include <bit>
#include <map>

#include "core/certificate/pair_queries.hpp"
#include "firmware_if/setup/surface_list.hpp"

namespace axg {
namespace {

using Corners = std::array<std::uint32_t, 9>;  // bits

Corners corners_of(const Triangle& triangle) noexcept {
    return std::bit_cast<Corners>(triangle);
}

/// Returns for each triangle of `part` the one of `whole` with the same corners; kNoIndex: none.
std::vector<std::uint32_t> places_in(const Mesh& part, const Mesh& whole) {
    std::map<Corners, std::uint32_t> places;
    for (std::uint32_t i = 0; i < whole.triangles.size(); ++i) {
        places.try_emplace(corners_of(whole.triangles[i]), i);
    }
    std::vector<std::uint32_t> out;
    for (const Triangle& triangle : part.triangles) {
        const auto found = places.find(corners_of(triangle));
        out.push_back(found == places.end() ? kNoIndex : found->second);
    }
    return out;
}

}  // namespace

BodyTriangles::BodyTriangles(const LoadedMachine& loaded)
    : first_(pair_mesh_index(loaded.machine, 0)), in_body_(loaded.meshes.of_pairs.size()) {
    const Machine& machine = loaded.machine;
    const SurfaceList surfaces = surface_list(loaded);
    for (const PairSurface& own : machine.pair_surfaces) {
        const bool is_tool = machine.bodies[own.body].is_tool;
        const std::uint32_t body = is_tool ? tool_mesh_index(machine, own.tool) : own.body;
        if (in_body_[own.surface].empty()) {  // of one body in all its pairs
            in_body_[own.surface] =
                places_in(loaded.meshes.of_pairs[own.surface], *surfaces.engines[body]);
        }
    }
}

std::uint32_t BodyTriangles::of(std::uint32_t mesh, std::uint32_t triangle) const noexcept {
    if (mesh < first_) {
        return triangle;
    }
    const std::size_t surface = mesh - first_;
    return surface < in_body_.size() && triangle < in_body_[surface].size()
               ? in_body_[surface][triangle]
               : kNoIndex;
}

TriangleIds BodyTriangles::of(const Query& query, TriangleIds found) const noexcept {
    return {of(query.mesh_a, found.a), of(query.mesh_b, found.b)};
}

}  // namespace axg
