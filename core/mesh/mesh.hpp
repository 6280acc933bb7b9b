// SPDX-License-Identifier: Apache-2.0
// A body's surface as triangles, float32 mm in the body's own frame: these numbers are the body,
// exactly.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec3.hpp"

namespace axg {

struct Triangle {
    Vec3f a, b, c;

    friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

/// How a body's tree groups its triangles (core/collision/tree.hpp): the slow part of building a
/// tree. It contains no boxes: these are computed from the triangles whenever a tree is raised.
struct TreeShape {
    std::vector<std::uint8_t> nodes;       // children of each node, or kLeafMark + triangles of a
                                           // leaf; depth first, parents before their children
    std::vector<std::uint32_t> triangles;  // of the leaves, one leaf after the other
};

/// Corners of one connected part: those with the least and the largest x, y and z, body frame, mm.
struct SurfacePart {
    Vec3f extreme[6];
};

/// Result of core/mesh/surface_parts.hpp for a surface.
struct SurfaceParts {
    std::vector<SurfacePart> parts;  // connected by shared corners, in the order of facets
    // [facets] 1: of a shell whose every edge is run along as often in one direction as in the
    // other
    std::vector<std::uint8_t> is_closed;
};

struct Mesh {
    std::string name;
    std::vector<Triangle> triangles;
    // Slow results about these triangles, from a compiled machine; empty: computed when needed.
    // They are valid for these triangles only.
    TreeShape shape{};
    SurfaceParts parts{};
};

}  // namespace axg
