// SPDX-License-Identifier: Apache-2.0
// A body's 32-wide tree of boxes: leaves of at most 32 triangles, boxes in the body's frame,
// structure of arrays, so that one test compares one box of a body with all children of a node of
// the other. Built at init, read-only in the cycle. Splits by the surface area heuristic (MacDonald
// and Booth, 1990); depth bounded by kTreeDepthMax for any input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/host_device.hpp"
#include "core/base/limits.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// Centre and half widths, mm. Contains its triangles in exact arithmetic: half widths are rounded
/// up.
struct Aabb {
    float c[3], h[3];
};

/// One node: its own box, and those of its children (nodes, or triangles in a leaf), padded with
/// boxes far away.
struct alignas(64) TreeNode {
    float c[3][kNodeWidth], h[3][kNodeWidth];  // children, one array a coordinate
    Aabb box;
    std::uint32_t count;        // children in use
    std::uint32_t first_child;  // index of the first child node; unused in a leaf
    std::uint32_t leaf;         // index into leaves; kNoLeaf: an inner node
    std::uint32_t more;         // of a leaf: charge for moving it, beyond one entry
};
inline constexpr std::uint32_t kNoLeaf = 0xffffffffU;

/// TreeNode::more of a leaf with more than kNodeWidth corners: the engine moves its vertices, three
/// times as many.
inline constexpr std::uint32_t kMoreForVertices = 2;

/// Charge to WorkLists::box_rows for a child of a, if both nodes are opened.
[[nodiscard]] AXG_HD constexpr std::uint32_t charged_rows(const TreeNode& child) noexcept {
    return 1 + child.more;
}
/// Charge to WorkLists::leaf_pairs.
[[nodiscard]] AXG_HD constexpr std::uint32_t charged_leaves(const TreeNode& a,
                                                            const TreeNode& b) noexcept {
    return 1 + a.more + b.more;
}

/// The triangles of one leaf, one array a coordinate (vertex 0 x y z, vertex 1 ..., vertex 2 ...),
/// filled up with copies of the first so that every lane holds a triangle of the leaf.
struct alignas(64) TreeLeaf {
    float v[9][kNodeWidth];
    std::uint32_t triangle[kNodeWidth];  // index into the mesh
};

/// The different corners of a leaf's triangles, one array a coordinate, filled up with copies of
/// the first. Neighbours share corners: to move these is to move the leaf, at a third of the cost.
struct alignas(64) LeafCorners {
    float v[3][kNodeWidth];
    std::uint8_t at[3][kNodeWidth];  // [vertex][triangle]: index into v
    std::uint32_t count;             // 0: they are more than kNodeWidth, and none is listed
};

struct TreeData {
    std::vector<TreeNode> nodes;  // [0] is the root
    std::vector<TreeLeaf> leaves;
    std::uint32_t depth = 0;
};

/// Whether every engine can use the mesh: triangles, all finite, within kCoordinateMmMax.
[[nodiscard]] bool has_usable_triangles(const Mesh& mesh) noexcept;

/// Largest |coordinate| of any vertex, mm.
[[nodiscard]] float reach_of(const Mesh& mesh) noexcept;

/// Marks a leaf in TreeShape::nodes: the other bits count its triangles.
inline constexpr std::uint8_t kLeafMark = 0x80;

/// Finds which triangles share a leaf and which nodes a parent. Allocates; init only, and slow:
/// it sorts the triangles again and again. Every triangle is in exactly one leaf.
/// Precondition: 1 to kTrianglesMax triangles, finite, |coordinate| <= kCoordinateMmMax.
[[nodiscard]] TreeShape group_triangles(std::span<const Triangle> triangles);

/// The shape stored in the mesh, or else the result of group_triangles().
[[nodiscard]] TreeShape shape_of(const Mesh& mesh);

/// Whether a shape from outside fits `triangle_count` triangles: 1 to kNodeWidth children, not
/// deeper than kTreeDepthMax, each triangle in exactly one leaf. Linear time.
[[nodiscard]] bool is_sound(const TreeShape& shape, std::size_t triangle_count);

struct TreeSize {
    std::size_t nodes = 0, leaves = 0;
    std::uint32_t depth = 0;
};
/// Precondition: a sound shape.
[[nodiscard]] TreeSize size_of(const TreeShape& shape) noexcept;

/// Writes the tree of that shape. A tree of any sound shape is right, for its boxes are made here;
/// a bad one is slow. Precondition: a sound shape, and room for exactly size_of() it.
void raise_tree(const TreeShape& shape, std::span<const Triangle> triangles,
                std::span<TreeNode> nodes, std::span<TreeLeaf> leaves) noexcept;

/// Groups the triangles and raises their tree, or that of the mesh's own shape. Allocates; init
/// only. Precondition: that of group_triangles().
[[nodiscard]] TreeData build_tree(std::span<const Triangle> triangles);
[[nodiscard]] TreeData build_tree(const Mesh& mesh);

[[nodiscard]] LeafCorners corners_of(const TreeLeaf& leaf) noexcept;

/// A tree where the engine reads it.
struct Tree {
    std::span<const TreeNode> nodes;
    std::span<const TreeLeaf> leaves;
    float reach_mm = 0;                      // largest |coordinate| of any vertex
    std::span<const LeafCorners> corners{};  // [leaves], or none: then all vertices are moved
};

/// Bodies as trees, for an engine whose bodies need not come from meshes.
struct TreeBodies {
    std::vector<TreeData> trees;
    std::vector<float> reach_mm;    // largest |coordinate| of each
    std::uint32_t tree_levels = 1;  // levels of node pairs that a query about two may open
};

}  // namespace axg
