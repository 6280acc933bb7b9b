// SPDX-License-Identifier: Apache-2.0
// Pairs of facets of one surface that cross or cover each other. Run once at load; the definition
// is check_mesh's.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/mesh.hpp"

namespace axg {

enum class FacetContact : std::uint8_t {
    none,      // apart, or touching by no more than the tolerance
    crosses,   // through each other
    same_way,  // overlapping in one plane, facing the same way
    opposed,   // overlapping in one plane, back to back
};

/// Judges two facets with area; symmetric. tolerance_mm: the least overlap, along every axis, that
/// counts. Cost: 11 axes at most, in double.
[[nodiscard]] FacetContact facet_contact(const Triangle& first, const Triangle& second,
                                         double tolerance_mm) noexcept;

struct SelfIntersections {
    std::uint32_t count = 0;     // crosses, same_way, and opposed within one shell
    std::uint32_t touching = 0;  // opposed, of two shells
    std::uint32_t first_a = 0, first_b = 0;
    bool complete = true;  // false: the limit of work or of findings was reached
};

/// @param facets  [n]
/// @param shell   [n] label of the part each facet belongs to
/// @param skip    [n] 1: a facet without area, left out
/// Cost: O(n log n) and the pairs whose boxes meet, at most 2^21 + 64 n of them.
[[nodiscard]] SelfIntersections find_self_intersections(std::span<const Triangle> facets,
                                                        std::span<const std::uint32_t> shell,
                                                        std::span<const std::uint8_t> skip,
                                                        double tolerance_mm);

}  // namespace axg
