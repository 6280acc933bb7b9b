// SPDX-License-Identifier: Apache-2.0
// How often the closed shells of a body wind around a point, exactly: 0 outside, 1 inside a solid,
// 0 again in its cavity. A ray along a coordinate axis is followed through the body's tree; rays
// through corners, along edges and in the planes of facets are no special case. Proof:
// docs/theory/accuracy.md, "Containment".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec3.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/tree.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// A body with an inside: the tree of its whole surface, and which of its triangles belong to
/// closed shells. Open shells bound nothing, and do not count.
struct Solid {
    Tree tree;
    std::span<const std::uint32_t> closed;  // [leaves] bit i: triangle i is of a closed shell
};

/// Solid::closed for a tree. is_closed: [triangles] 1: of a closed shell. Init only.
[[nodiscard]] std::vector<std::uint32_t> closed_masks(std::span<const TreeNode> nodes,
                                                      std::span<const TreeLeaf> leaves,
                                                      std::span<const std::uint8_t> is_closed);

/// Grid of all queried points, so that no product of three differences can underflow.
inline constexpr double kPointGridMm = 0x1p-34;

/// The nearest point of that grid. Precondition: |coordinate| below 2^17.
[[nodiscard]] inline Vec3d on_point_grid(const Vec3d& p) noexcept {
    constexpr double kRound = 0x1.8p52 * kPointGridMm;  // its last bit is one step of the grid
    return {(p.x + kRound) - kRound, (p.y + kRound) - kRound, (p.z + kRound) - kRound};
}

/// Work of all rays of one query together; a counter beyond its capacity sets the status.
struct RayWork {
    QueryStatus status = QueryStatus::ok;
    std::uint32_t nodes = 0;        // opened; against Capacities::node_pairs
    std::uint32_t triangles = 0;    // tested; against Capacities::triangle_pairs
    std::uint32_t exact_signs = 0;  // beyond double; against pose_rechecks()
};

struct Winding {
    bool is_known = false;  // false: a capacity was too small, or the point is on the surface
    int number = 0;
};

/// The winding number of the closed shells of `solid` around `point`, body frame, mm.
/// Precondition: the point is on the grid and on no triangle of a closed shell; |coordinate|
/// below 2^17; the tree has a node. Cost: the nodes and triangles above the point along the ray
/// that leaves the body's box soonest, within the capacities. Allocates nothing.
[[nodiscard]] Winding winding_number(const Solid& solid, const Vec3d& point,
                                     const Capacities& capacities, RayWork& work) noexcept;

}  // namespace axg
