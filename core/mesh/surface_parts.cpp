// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/surface_parts.hpp"

#include <cstddef>

#include "core/mesh/mesh_topology.hpp"

namespace axg {
namespace {

std::vector<std::uint8_t> closed_facets(const MeshTopology& topology) {
    const std::vector<std::uint32_t> shell = label_shells(topology);
    std::vector<std::uint8_t> is_open(shell.size(), 0);  // of the shell with that label
    for (std::size_t i = 0; i < shell.size(); ++i) {
        is_open[shell[i]] |= topology.has_bad_edge[i];
    }
    std::vector<std::uint8_t> is_closed(shell.size());
    for (std::size_t i = 0; i < shell.size(); ++i) {
        is_closed[i] = is_open[shell[i]] == 0 ? 1 : 0;
    }
    return is_closed;
}

std::vector<std::uint32_t> label_parts(const MeshTopology& topology) {
    constexpr std::uint32_t kNobody = 0xffffffffU;
    FacetSets sets(topology.ids.size());
    std::vector<std::uint32_t> first(topology.vertex.size(), kNobody);  // facet at that corner
    for (std::uint32_t i = 0; i < topology.ids.size(); ++i) {
        for (const std::uint32_t corner : topology.ids[i]) {
            if (first[corner] == kNobody) {
                first[corner] = i;
            } else {
                sets.join(first[corner], i);
            }
        }
    }
    return sets.labels();
}

void stretch(SurfacePart& part, const Vec3f& p) noexcept {
    constexpr float Vec3f::*kAlong[] = {&Vec3f::x, &Vec3f::y, &Vec3f::z};
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3f& least = part.extreme[2 * k];
        Vec3f& most = part.extreme[2 * k + 1];
        least = p.*kAlong[k] < least.*kAlong[k] ? p : least;
        most = p.*kAlong[k] > most.*kAlong[k] ? p : most;
    }
}

}  // namespace

SurfaceParts take_apart(std::span<const Triangle> facets) {
    const MeshTopology topology = topology_of(facets);
    SurfaceParts out;
    out.is_closed = closed_facets(topology);
    const std::vector<std::uint32_t> label = label_parts(topology);
    std::vector<std::uint32_t> index(facets.size());  // of the part with that label
    for (std::size_t i = 0; i < facets.size(); ++i) {
        if (label[i] == i) {  // the lowest facet of its part: seen before all others
            index[i] = static_cast<std::uint32_t>(out.parts.size());
            const Vec3f& a = facets[i].a;
            out.parts.push_back({{a, a, a, a, a, a}});
        }
        for (const Vec3f& corner : {facets[i].a, facets[i].b, facets[i].c}) {
            stretch(out.parts[index[label[i]]], corner);
        }
    }
    return out;
}

SurfaceParts parts_of(const Mesh& mesh) {
    return mesh.parts.is_closed.size() == mesh.triangles.size() ? mesh.parts
                                                                : take_apart(mesh.triangles);
}

}  // namespace axg
