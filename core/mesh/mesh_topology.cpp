// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/mesh_topology.hpp"

#include <numeric>

namespace axg {
namespace {

void merge_vertices(std::span<const Triangle> facets, MeshTopology& out) {
    struct Corner {
        Vec3f at;
        std::uint32_t index;
    };
    std::vector<Corner> corners;
    corners.reserve(3 * facets.size());
    const auto plus_zero = [](Vec3f p) { return Vec3f{p.x + 0.0F, p.y + 0.0F, p.z + 0.0F}; };
    for (const Triangle& t : facets) {
        for (const Vec3f p : {t.a, t.b, t.c}) {
            corners.push_back({plus_zero(p), static_cast<std::uint32_t>(corners.size())});
        }
    }
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
        if (a.at.x != b.at.x) {
            return a.at.x < b.at.x;
        }
        return a.at.y != b.at.y ? a.at.y < b.at.y : a.at.z < b.at.z;
    });
    out.ids.resize(facets.size());
    for (const Corner& corner : corners) {
        if (out.vertex.empty() || out.vertex.back() != corner.at) {
            out.vertex.push_back(corner.at);
        }
        out.ids[corner.index / 3][corner.index % 3] =
            static_cast<std::uint32_t>(out.vertex.size() - 1);
    }
}

void collect_edges(MeshTopology& topology) {
    topology.uses.reserve(3 * topology.ids.size());
    for (std::uint32_t i = 0; i < topology.ids.size(); ++i) {
        const MeshTopology::Ids& v = topology.ids[i];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = v[k], to = v[(k + 1) % 3];
            topology.uses.push_back({edge_key(from, to), i, from < to});
        }
    }
    std::sort(topology.uses.begin(), topology.uses.end());
}

void mark_bad_edges(MeshTopology& topology) {
    topology.has_bad_edge.assign(topology.ids.size(), 0);
    for_each_edge(topology, [&topology](std::span<const EdgeUse> uses) {
        const auto forward = std::count_if(uses.begin(), uses.end(),
                                           [](const EdgeUse& use) { return use.is_forward; });
        if (2 * forward == static_cast<std::ptrdiff_t>(uses.size())) {
            return;
        }
        for (const EdgeUse& use : uses) {
            topology.has_bad_edge[use.facet] = 1;
        }
    });
}

}  // namespace

MeshTopology topology_of(std::span<const Triangle> facets) {
    MeshTopology topology;
    merge_vertices(facets, topology);
    collect_edges(topology);
    mark_bad_edges(topology);
    return topology;
}

FacetSets::FacetSets(std::size_t facet_count) : root_(facet_count) {
    std::iota(root_.begin(), root_.end(), 0U);
}

std::uint32_t FacetSets::find(std::uint32_t facet) noexcept {
    while (root_[facet] != facet) {
        root_[facet] = root_[root_[facet]];
        facet = root_[facet];
    }
    return facet;
}

void FacetSets::join(std::uint32_t a, std::uint32_t b) noexcept {
    a = find(a);
    b = find(b);
    root_[std::max(a, b)] = std::min(a, b);
}

std::vector<std::uint32_t> FacetSets::labels() {
    std::vector<std::uint32_t> out(root_.size());
    for (std::uint32_t i = 0; i < out.size(); ++i) {
        out[i] = find(i);
    }
    return out;
}

std::vector<std::uint32_t> label_shells(const MeshTopology& topology) {
    FacetSets sets(topology.ids.size());
    for_each_edge(topology, [&sets](std::span<const EdgeUse> uses) {
        for (const EdgeUse& use : uses.subspan(1)) {
            sets.join(uses[0].facet, use.facet);
        }
    });
    return sets.labels();
}

}  // namespace axg
