// SPDX-License-Identifier: Apache-2.0
// A surface taken apart for containment: which facets belong to a closed shell, and a few corners
// of each connected part. Init only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.hpp"

namespace axg {

/// Corners of one connected part: those with the least and the largest x, y and z, body frame, mm.
struct SurfacePart {
    Vec3f extreme[6];
};

struct SurfaceParts {
    std::vector<SurfacePart> parts;       // connected by shared corners, in the order of facets
    std::vector<std::uint8_t> is_closed;  // [facets] 1: of a shell whose every edge has two facets
                                          // that run along it in opposite directions
};

/// Corners are shared when their coordinates are equal, as in check_mesh. Allocates.
[[nodiscard]] SurfaceParts take_apart(std::span<const Triangle> facets);

}  // namespace axg
