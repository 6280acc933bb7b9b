// SPDX-License-Identifier: Apache-2.0
// The distance of two surfaces in double, for tests and scene making. Shares no code with the
// engines: every value is the length between two points of the surfaces, so that up to the rounding
// of double it is never below the true distance, whatever the tree leaves out.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::test {

/// Binary tree of boxes over one surface, in the body's frame.
class DistanceTree {
  public:
    /// Precondition: at least one triangle.
    explicit DistanceTree(const std::vector<Triangle>& triangles);

    struct Aabb {
        double c[3], h[3];
    };
    struct Node {
        Aabb box;
        std::uint32_t first = 0, count = 0;  // triangles of a leaf; count 0: an inner node
        std::uint32_t children[2] = {0, 0};
    };
    struct Facet {
        Vec3d v[3];
    };
    std::vector<Node> nodes;  // [0] is the root
    std::vector<Facet> facets;

  private:
    std::uint32_t build(std::uint32_t first, std::uint32_t count);
};

/// Distance in mm of a, placed at `pose` in b's frame, to b; `cap_mm` when it is not below that.
/// 0 when a triangle's edge passes through a triangle of the other.
[[nodiscard]] double surface_distance(const DistanceTree& a, const DistanceTree& b,
                                      const Pose& pose, double cap_mm);

/// Distance of two triangles, mm; 0 when an edge of one passes through the other.
[[nodiscard]] double triangle_distance(const DistanceTree::Facet& a, const DistanceTree::Facet& b);

}  // namespace axg::test
