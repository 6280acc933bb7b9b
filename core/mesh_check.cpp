// SPDX-License-Identifier: Apache-2.0
#include "core/mesh_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/mesh_shells.hpp"
#include "core/self_intersect.hpp"
#include "core/zero_area.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kOpenEdgesExaminedMax = 2048;  // for T-junctions, each against each

using Ids = std::array<std::uint32_t, 3>;  // of the merged vertices of a facet

/// One use of an edge by a facet. Sorted by key, then facet.
struct EdgeUse {
    std::uint64_t key;  // lower vertex id above, higher below
    std::uint32_t facet;
    bool is_forward;  // from the lower id to the higher

    friend bool operator<(const EdgeUse& a, const EdgeUse& b) {
        return a.key != b.key ? a.key < b.key : a.facet < b.facet;
    }
};

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) | std::max(a, b);
}

struct Topology {
    std::vector<Vec3f> vertex;  // [vertex ids]
    std::vector<Ids> ids;       // [facets]
    std::vector<EdgeUse> uses;
    std::vector<std::uint8_t> is_flat;       // [facets] 1: no area
    std::vector<std::uint8_t> has_bad_edge;  // [facets] 1: open, non-manifold or flipped edge
};

/// Merges vertices of equal coordinates; -0 counts as +0.
void merge_vertices(std::span<const Triangle> facets, Topology& out) {
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

void collect_edges(Topology& topology) {
    topology.uses.reserve(3 * topology.ids.size());
    for (std::uint32_t i = 0; i < topology.ids.size(); ++i) {
        const Ids& v = topology.ids[i];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            continue;  // its two equal edges would cancel; its neighbours meet without it
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = v[k], to = v[(k + 1) % 3];
            topology.uses.push_back({edge_key(from, to), i, from < to});
        }
    }
    std::sort(topology.uses.begin(), topology.uses.end());
}

/// Calls visit(uses of one edge) for each edge.
template <class Visit>
void for_each_edge(const Topology& topology, const Visit& visit) {
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

void count_edges(Topology& topology, std::vector<std::uint64_t>& open, MeshReport& report) {
    topology.has_bad_edge.assign(topology.ids.size(), 0);
    const auto add = [&](std::uint32_t& count, std::uint32_t& first,
                         std::span<const EdgeUse> uses) {
        ++count;
        for (const EdgeUse& use : uses) {
            first = std::min(first, use.facet);
            topology.has_bad_edge[use.facet] = 1;
        }
    };
    for_each_edge(topology, [&](std::span<const EdgeUse> uses) {
        if (uses.size() == 1) {
            add(report.open_edges, report.first_open, uses);
            open.push_back(uses[0].key);
        } else if (uses.size() > 2) {
            add(report.non_manifold_edges, report.first_non_manifold, uses);
        } else if (uses[0].is_forward == uses[1].is_forward) {
            add(report.flipped_edges, report.first_flipped, uses);
        }
    });
}

/// Ends of open edges strictly inside another open edge, to within the tolerance: where a neighbour
/// was not split.
std::uint32_t count_t_junctions(const Topology& topology, std::span<const std::uint64_t> open,
                                double tolerance_mm) {
    if (open.size() > kOpenEdgesExaminedMax) {
        return 0;  // a surface that is open all over: T-junctions are not what is wrong
    }
    std::vector<std::uint32_t> ends;
    for (const std::uint64_t key : open) {
        ends.push_back(static_cast<std::uint32_t>(key >> 32U));
        ends.push_back(static_cast<std::uint32_t>(key));
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::uint32_t count = 0;
    for (const std::uint32_t end : ends) {
        const Vec3d p = widen(topology.vertex[end]);
        count += std::any_of(open.begin(), open.end(), [&](std::uint64_t key) {
            const Vec3d a = widen(topology.vertex[key >> 32U]);
            const Vec3d along = widen(topology.vertex[key & 0xffffffffU]) - a;
            const double length_2 = dot(along, along), s = dot(p - a, along);
            const Vec3d off = cross(p - a, along);
            return s > 0 && s < length_2 &&
                   dot(off, off) <= tolerance_mm * tolerance_mm * length_2 && p != a &&
                   p != a + along;
        });
    }
    return count;
}

/// Facets without area, and which of them lie on an edge (or corner) of a facet with area.
void find_degenerate(std::span<const Triangle> facets, Topology& topology, MeshReport& report) {
    topology.is_flat.assign(facets.size(), 0);
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
        if (has_zero_area(facets[i])) {
            topology.is_flat[i] = 1;
            report.first_degenerate = std::min(report.first_degenerate, i);
            ++report.degenerate_facets;
        }
    }
    if (report.degenerate_facets == 0) {
        return;
    }
    std::vector<std::uint64_t> solid_edges;
    std::vector<std::uint8_t> is_solid_vertex(topology.vertex.size(), 0);
    for (const EdgeUse& use : topology.uses) {  // sorted: solid_edges is sorted too
        if (topology.is_flat[use.facet] == 0) {
            solid_edges.push_back(use.key);
            is_solid_vertex[use.key >> 32U] = 1;
            is_solid_vertex[use.key & 0xffffffffU] = 1;
        }
    }
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
        if (topology.is_flat[i] == 0) {
            continue;
        }
        const Ids& v = topology.ids[i];
        std::uint32_t from = v[0], to = v[0];  // the longest edge is all of a flat facet
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d along =
                widen(topology.vertex[v[k]]) - widen(topology.vertex[v[(k + 1) % 3]]);
            if (dot(along, along) > longest) {
                longest = dot(along, along);
                from = v[k];
                to = v[(k + 1) % 3];
            }
        }
        const bool is_covered =
            from == to
                ? is_solid_vertex[from] != 0
                : std::binary_search(solid_edges.begin(), solid_edges.end(), edge_key(from, to));
        if (is_covered) {
            report.droppable.push_back(i);
        }
    }
}

void count_doubled(const Topology& topology, MeshReport& report) {
    struct Named {
        Ids ids;
        std::uint32_t facet;
    };
    std::vector<Named> sorted;
    for (std::uint32_t i = 0; i < topology.ids.size(); ++i) {
        if (topology.is_flat[i] == 0) {
            sorted.push_back({topology.ids[i], i});
            std::sort(sorted.back().ids.begin(), sorted.back().ids.end());
        }
    }
    std::sort(sorted.begin(), sorted.end(), [](const Named& a, const Named& b) {
        return a.ids != b.ids ? a.ids < b.ids : a.facet < b.facet;
    });
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i].ids == sorted[i - 1].ids) {
            ++report.doubled_facets;
            report.first_doubled = std::min(report.first_doubled, sorted[i].facet);
        }
    }
}

/// Parts connected by edges: a label a facet, the lowest facet index of the part.
std::vector<std::uint32_t> label_shells(const Topology& topology) {
    std::vector<std::uint32_t> root(topology.ids.size());
    for (std::uint32_t i = 0; i < root.size(); ++i) {
        root[i] = i;
    }
    const auto find = [&root](std::uint32_t i) {
        while (root[i] != i) {
            root[i] = root[root[i]];
            i = root[i];
        }
        return i;
    };
    for_each_edge(topology, [&](std::span<const EdgeUse> uses) {
        for (const EdgeUse& use : uses.subspan(1)) {
            const std::uint32_t a = find(uses[0].facet), b = find(use.facet);
            root[std::max(a, b)] = std::min(a, b);
        }
    });
    for (std::uint32_t i = 0; i < root.size(); ++i) {
        root[i] = find(i);
    }
    return root;
}

/// The box; returns the largest |coordinate|.
double measure(std::span<const Triangle> facets, MeshReport& report) {
    report.min_mm = report.max_mm = facets[0].a;
    for (const Triangle& t : facets) {
        for (const Vec3f p : {t.a, t.b, t.c}) {
            report.min_mm = {std::min(report.min_mm.x, p.x), std::min(report.min_mm.y, p.y),
                             std::min(report.min_mm.z, p.z)};
            report.max_mm = {std::max(report.max_mm.x, p.x), std::max(report.max_mm.y, p.y),
                             std::max(report.max_mm.z, p.z)};
        }
    }
    const Vec3f low = report.min_mm, high = report.max_mm;
    return static_cast<double>(std::max({-low.x, -low.y, -low.z, high.x, high.y, high.z}));
}

}  // namespace

MeshReport check_mesh(std::span<const Triangle> triangles) {
    MeshReport report;
    report.facet_count = static_cast<std::uint32_t>(triangles.size());
    if (triangles.empty()) {
        return report;
    }
    report.tolerance_mm = 0x1p-23 * measure(triangles, report);
    Topology topology;
    merge_vertices(triangles, topology);
    report.vertex_count = static_cast<std::uint32_t>(topology.vertex.size());
    collect_edges(topology);
    std::vector<std::uint64_t> open;
    count_edges(topology, open, report);
    report.t_junctions = count_t_junctions(topology, open, report.tolerance_mm);
    find_degenerate(triangles, topology, report);
    count_doubled(topology, report);
    const std::vector<std::uint32_t> shell = label_shells(topology);
    judge_shells({triangles, shell, topology.is_flat, topology.has_bad_edge}, report);
    const SelfIntersections found =
        find_self_intersections(triangles, shell, topology.is_flat, report.tolerance_mm);
    report.self_intersections = found.count;
    report.touching_pairs = found.touching;
    report.self_complete = found.complete;
    if (found.count != 0) {
        report.self_a = found.first_a;
        report.self_b = found.first_b;
    }
    return report;
}

}  // namespace axg
