// SPDX-License-Identifier: Apache-2.0
// The parts of a surface: which is solid, which is a cavity, which is turned inside out. Part of
// check_mesh.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/mesh_check.hpp"

namespace axg {

struct LabelledFacets {
    std::span<const Triangle> facets;
    std::span<const std::uint32_t> shell;  // [facets] the lowest facet index of its part
    std::span<const std::uint8_t>
        is_flat;  // [facets] 1: no area; a part of such facets only is skipped
    std::span<const std::uint8_t> has_bad_edge;  // [facets] 1: the part is not closed
};

/// Fills shells, cavities, inverted_shells, nested_shells, flat_shells, volume_mm3 and
/// shells_complete. The winding number of the other closed parts around one point of a part decides
/// whether the part is inside them. Cost: linear for one part; at most 2^24 facet angles for many.
void judge_shells(const LabelledFacets& labelled, MeshReport& report);

}  // namespace axg
