// SPDX-License-Identifier: Apache-2.0
// Which facets of a surface meet: corners merged by equal coordinates, edges with all their uses,
// parts connected by edges. Init only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg {

/// One use of an edge by a facet. Sorted by key, then facet.
struct EdgeUse {
    std::uint64_t key;  // lower vertex id above, higher below
    std::uint32_t facet;
    bool is_forward;  // from the lower id to the higher

    friend bool operator<(const EdgeUse& a, const EdgeUse& b) noexcept {
        return a.key != b.key ? a.key < b.key : a.facet < b.facet;
    }
};

[[nodiscard]] inline std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) noexcept {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) | std::max(a, b);
}

struct MeshTopology {
    using Ids = std::array<std::uint32_t, 3>;  // of the merged vertices of a facet

    std::vector<Vec3f> vertex;  // [vertex ids]
    std::vector<Ids> ids;       // [facets]
    std::vector<EdgeUse> uses;
    // [facets] 1: an edge that is not run along as often in one direction as in the other. Without
    // one the surface has no border, and so a winding number, even if two solids share an edge.
    std::vector<std::uint8_t> has_bad_edge;
};

/// Merges vertices of equal coordinates, never by a tolerance; -0 counts as +0. Facets with two
/// equal vertices have no edges: theirs would cancel, and their neighbours meet without them.
[[nodiscard]] MeshTopology topology_of(std::span<const Triangle> facets);

/// Calls visit(uses of one edge) for each edge.
template <class Visit>
void for_each_edge(const MeshTopology& topology, const Visit& visit) {
    const std::span<const EdgeUse> uses(topology.uses);
    for (std::size_t i = 0; i < uses.size();) {
        std::size_t end = i + 1;
        while (end < uses.size() && uses[end].key == uses[i].key) {
            ++end;
        }
        visit(uses.subspan(i, end - i));
        i = end;
    }
}

/// Sets of facets that grow together. A set is named by its lowest facet.
class FacetSets {
  public:
    explicit FacetSets(std::size_t facet_count);
    void join(std::uint32_t a, std::uint32_t b) noexcept;
    [[nodiscard]] std::uint32_t find(std::uint32_t facet) noexcept;
    [[nodiscard]] std::vector<std::uint32_t> labels();  // [facets] name of its set

  private:
    std::vector<std::uint32_t> root_;
};

/// Parts connected by edges: a label a facet, the lowest facet index of the part.
[[nodiscard]] std::vector<std::uint32_t> label_shells(const MeshTopology& topology);

}  // namespace axg
