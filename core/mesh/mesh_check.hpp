// SPDX-License-Identifier: Apache-2.0
// Is a triangle list the surface of a solid? Closedness, orientation, shells, degenerate and
// doubled facets, self-intersection. Pure; run once at load, never in the cycle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg {

/// Findings as counts; `first_*` are facet indices, kNoFacet when there is none.
/// Vertices are merged by equal coordinates (-0 equals +0), never by a tolerance.
/// The edge counts ignore facets with two equal vertices, but include those that are only
/// collinear: they close gaps.
struct MeshReport {
    static constexpr std::uint32_t kNoFacet = 0xffffffffU;

    std::uint32_t facet_count = 0, vertex_count = 0;
    Vec3f min_mm, max_mm;  // bounding box

    std::uint32_t open_edges = 0;   // used by one facet
    std::uint32_t t_junctions = 0;  // vertices of open edges that are inside another open edge
    std::uint32_t non_manifold_edges = 0;  // used by more than two facets
    std::uint32_t flipped_edges = 0;  // used twice in the same direction: one facet is turned over
    std::uint32_t first_open = kNoFacet, first_non_manifold = kNoFacet, first_flipped = kNoFacet;

    std::uint32_t degenerate_facets = 0;  // area exactly zero, two equal vertices included
    std::uint32_t first_degenerate = kNoFacet;
    /// Degenerate facets with two equal vertices whose whole point set is on an edge of a facet
    /// with area: removing them changes nothing, and opens nothing.
    std::vector<std::uint32_t> droppable;

    std::uint32_t doubled_facets = 0;  // the same three vertices once more, in either direction
    std::uint32_t first_doubled = kNoFacet;

    std::uint32_t shells = 0;           // parts connected by edges
    std::uint32_t open_shells = 0;      // those that are not closed: they have no inside
    std::uint32_t cavities = 0;         // closed, negative volume, inside another shell: legal
    std::uint32_t inverted_shells = 0;  // closed, negative volume, inside nothing
    std::uint32_t nested_shells = 0;  // closed, positive volume, inside a solid part: counted twice
    std::uint32_t flat_shells = 0;    // closed without volume
    std::uint32_t first_inverted = kNoFacet, first_nested = kNoFacet;
    double volume_mm3 = 0;  // sum over the closed shells

    /// Pairs of facets that cross, or overlap in one plane, by more than `tolerance_mm`;
    /// see check_mesh.
    std::uint32_t self_intersections = 0;
    std::uint32_t self_a = kNoFacet, self_b = kNoFacet;  // the first such pair
    std::uint32_t touching_pairs =
        0;  // overlapping back to back in one plane, of two shells: two solids in contact
    bool self_complete =
        true;  // false: the work limit was reached, self_intersections is a lower bound
    bool shells_complete = true;  // false: too many shells to find which is inside which
    double tolerance_mm = 0;

    [[nodiscard]] bool is_closed() const noexcept {
        return open_edges == 0 && non_manifold_edges == 0 && flipped_edges == 0;
    }
};

/// Examines one surface. Coordinates are finite and within kCoordinateMmMax (read_stl's promise).
///
/// Self-intersection: facets count as crossing when no separating axis leaves them an overlap of
/// less than tolerance_mm = 2^-23 of the largest |coordinate|, about one unit in the last place of
/// float32: less is the rounding of the file, and facets of a true solid that merely touch are
/// none. Facets that share an edge or a vertex are judged by the same rule; folded flat onto each
/// other they overlap. Facets of two different shells that are back to back in one plane are solids
/// in contact: `touching_pairs`, no intersection. Cost: O(n log n) for sane meshes; the pair tests
/// are limited to 2^21 + 64 n for any input.
[[nodiscard]] MeshReport check_mesh(std::span<const Triangle> triangles);

}  // namespace axg
