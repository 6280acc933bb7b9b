// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/mesh_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/mesh/mesh_shells.hpp"
#include "core/mesh/mesh_topology.hpp"
#include "core/mesh/self_intersect.hpp"
#include "core/mesh/zero_area.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kOpenEdgesExaminedMax = 2048;  // for T-junctions, each against each

using Ids = MeshTopology::Ids;

void count_edges(const MeshTopology& topology, std::vector<std::uint64_t>& open,
                 MeshReport& report) {
    const auto add = [&](std::uint32_t& count, std::uint32_t& first,
                         std::span<const EdgeUse> uses) {
        ++count;
        for (const EdgeUse& use : uses) {
            first = std::min(first, use.facet);
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
std::uint32_t count_t_junctions(const MeshTopology& topology, std::span<const std::uint64_t> open,
                                double tolerance_mm) {
    if (open.size() > kOpenEdgesExaminedMax) {
        return 0;  // a surface that is open all over: T-junctions are not its fault
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

/// Finds facets without area, and those of them that are on an edge (or corner) of a facet with
/// area. Returns [facets] 1: no area.
std::vector<std::uint8_t> find_degenerate(std::span<const Triangle> facets,
                                          const MeshTopology& topology, MeshReport& report) {
    std::vector<std::uint8_t> is_flat(facets.size(), 0);
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
        if (has_zero_area(facets[i])) {
            is_flat[i] = 1;
            report.first_degenerate = std::min(report.first_degenerate, i);
            ++report.degenerate_facets;
        }
    }
    if (report.degenerate_facets == 0) {
        return is_flat;
    }
    std::vector<std::uint64_t> solid_edges;
    std::vector<std::uint8_t> is_solid_vertex(topology.vertex.size(), 0);
    for (const EdgeUse& use : topology.uses) {  // sorted: solid_edges is sorted too
        if (is_flat[use.facet] == 0) {
            solid_edges.push_back(use.key);
            is_solid_vertex[use.key >> 32U] = 1;
            is_solid_vertex[use.key & 0xffffffffU] = 1;
        }
    }
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
        const Ids& v = topology.ids[i];
        const bool has_equal_corners = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
        if (is_flat[i] == 0 || !has_equal_corners) {
            continue;  // three corners on a line may close a gap between neighbours: it stays
        }
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
    return is_flat;
}

void count_doubled(const MeshTopology& topology, const std::vector<std::uint8_t>& is_flat,
                   MeshReport& report) {
    struct Named {
        Ids ids;
        std::uint32_t facet;
    };
    std::vector<Named> sorted;
    for (std::uint32_t i = 0; i < topology.ids.size(); ++i) {
        if (is_flat[i] == 0) {
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

/// Computes the bounding box; returns the largest |coordinate|.
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
    const MeshTopology topology = topology_of(triangles);
    report.vertex_count = static_cast<std::uint32_t>(topology.vertex.size());
    std::vector<std::uint64_t> open;
    count_edges(topology, open, report);
    report.t_junctions = count_t_junctions(topology, open, report.tolerance_mm);
    const std::vector<std::uint8_t> is_flat = find_degenerate(triangles, topology, report);
    count_doubled(topology, is_flat, report);
    const std::vector<std::uint32_t> shell = label_shells(topology);
    judge_shells({triangles, shell, is_flat, topology.has_bad_edge}, report);
    const SelfIntersections found =
        find_self_intersections(triangles, shell, is_flat, report.tolerance_mm);
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
