// SPDX-License-Identifier: Apache-2.0
// Constructed trees, and leaves with a chosen number of entries in every list. The children of a
// node are on a line: a child of a is near the child of b in the same slot and near no other. Boxes
// may be larger than their contents, and nodes share children. mm.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/base/limits.hpp"
#include "core/collision/tree.hpp"

namespace axg {

// Two triangles whose corners are 1.27 mm apart and which, at a margin of 1 mm, neither the shared
// axes nor the seventeen prove apart: only the closest direction does. Found by random search;
// tests/unit/core/worst_case/worst_case_batch_test checks them.
inline constexpr float kCorner[9] = {-0.625F,   -0.78125F, -0.78125F, -2.875F,  -5.03125F,
                                     -5.03125F, -1.875F,   -1.78125F, -2.28125F};
inline constexpr float kOther[9] = {0, 0, 0, 0.25F, 2.75F, 0.75F, 2, 4.5F, 4};
// Exactly the margin away from kOther, corner to corner: neither certified within it nor apart in
// float, and in double neither.
inline constexpr float kBeside[9] = {-1, 0, 0, -2.5F, -1, -1.25F, -2, -2.5F, -0.5F};

inline constexpr float kSlotMm =
    40;  // children of a node are on a line, far more than the margin apart
inline constexpr std::uint32_t kChildren = kNodeWidth;
inline constexpr float kLineMm = kSlotMm * kChildren;
// Half widths of the boxes of children: a's have room for a leaf that b's do not reach.
inline constexpr float kHalfA = 18, kHalfB = 8;
inline constexpr float kFarMm = 1.0e30F;

/// A pair of leaves: every triangle of a is near every one of b; `touching` of a's touch all of b.
/// none_near: the boxes of the leaves overlap, but no boxes of two triangles do.
struct LeafRecipe {
    std::uint32_t a = kChildren, b = 1, touching = 0;
    bool none_near = false;

    friend auto operator<=>(const LeafRecipe&, const LeafRecipe&) = default;

    [[nodiscard]] std::uint32_t pairs() const { return none_near ? 0 : a * b; }
    /// Rows of boxes in the clipping. With one triangle of b none of a is near all of b.
    [[nodiscard]] std::uint32_t rows() const { return none_near && b == 1 ? 0 : b; }
};

class TreeMaker {
  public:
    /// @param half_mm  half width of the children's boxes
    explicit TreeMaker(float half_mm) : half_mm_(half_mm) { data_.nodes.emplace_back(blank()); }

    /// Adds `count` children to `node`, in a row from the index that it returns.
    std::uint32_t add_children(std::uint32_t node, std::uint32_t count) {
        const auto first = static_cast<std::uint32_t>(data_.nodes.size());
        data_.nodes.resize(first + count, blank());
        data_.nodes[node].count = count;
        data_.nodes[node].first_child = first;
        for (std::uint32_t i = 0; i < count; ++i) {
            place_box(data_.nodes[node], i, slot(i), half_mm_);
        }
        return first;
    }
    /// Moves the box of a child to another slot than its own.
    void move_box(std::uint32_t node, std::uint32_t i, std::uint32_t to) {
        place_box(data_.nodes[node], i, slot(to), half_mm_);
    }
    /// Fills all slots with boxes of children. Those after the last child are never near any other:
    /// they are far away, or in slots where the other body has no child.
    void fill_boxes(std::uint32_t node, bool is_far) {
        for (std::uint32_t i = data_.nodes[node].count; !is_far && i < kChildren; ++i) {
            place_box(data_.nodes[node], i, slot(i), half_mm_);
        }
        data_.nodes[node].count = kChildren;
    }
    [[nodiscard]] std::size_t size_bytes() const {
        return data_.nodes.size() * sizeof(TreeNode) + data_.leaves.size() * sizeof(TreeLeaf);
    }
    void share_children(std::uint32_t to, std::uint32_t from) {
        data_.nodes[to] = data_.nodes[from];
    }
    /// Makes a leaf in slot `i` of its parent; `shape_of` returns nine coordinates a triangle.
    template <class ShapeOf>
    void make_leaf(std::uint32_t node, std::uint32_t i, std::uint32_t count,
                   const ShapeOf& shape_of) {
        TreeNode& to = data_.nodes[node];
        TreeLeaf leaf{};
        to.leaf = static_cast<std::uint32_t>(data_.leaves.size());
        to.count = count;
        to.box = {{0, 0, slot(i)}, {half_mm_, half_mm_, half_mm_}};
        for (std::uint32_t t = 0; t < kChildren; ++t) {
            const std::uint32_t own = t < count ? t : 0;
            leaf.triangle[t] = next_triangle_ + own;
            std::array<float, 9> v = shape_of(own);
            float low[3] = {kFarMm, kFarMm, kFarMm}, high[3] = {-kFarMm, -kFarMm, -kFarMm};
            for (unsigned k = 0; k < 9; ++k) {
                v[k] += k % 3 == 2 ? slot(i) : 0;
                leaf.v[k][t] = v[k];
                low[k % 3] = std::min(low[k % 3], v[k]);
                high[k % 3] = std::max(high[k % 3], v[k]);
            }
            for (int k = 0; t < count && k < 3; ++k) {  // exact: quarters and 32nds of a mm
                to.c[k][t] = 0.5F * (low[k] + high[k]);
                to.h[k][t] = 0.5F * (high[k] - low[k]);
            }
        }
        next_triangle_ += count;
        data_.leaves.push_back(leaf);
    }
    TreeData take(std::uint32_t depth) {
        data_.depth = depth;
        return std::move(data_);
    }

  private:
    static float slot(std::uint32_t i) { return kSlotMm * static_cast<float>(i); }
    static TreeNode blank() {
        TreeNode node{};
        for (int k = 0; k < 3; ++k) {
            std::fill_n(node.c[k], kChildren, kFarMm);
        }
        node.box = {{0, 0, kLineMm / 2}, {kHalfA, kHalfA, kLineMm}};
        node.leaf = kNoLeaf;
        return node;
    }
    static void place_box(TreeNode& node, std::uint32_t i, float z_mm, float half_mm) {
        for (int k = 0; k < 3; ++k) {
            node.c[k][i] = k == 2 ? z_mm : 0;
            node.h[k][i] = half_mm;
        }
    }

    TreeData data_;
    float half_mm_;
    std::uint32_t next_triangle_ = 0;
};

/// Makes two leaves in the same slot below two nodes, by the recipe.
void make_leaf_pair(TreeMaker& a, std::uint32_t node_a, TreeMaker& b, std::uint32_t node_b,
                    std::uint32_t slot, const LeafRecipe& recipe);

/// The same with full leaves: triangles far from all others fill them up, and the near ones of a
/// are spread over as many lanes as possible.
void make_full_leaf_of_a(TreeMaker& a, std::uint32_t node, std::uint32_t slot,
                         const LeafRecipe& recipe);
void make_full_leaf_of_b(TreeMaker& b, std::uint32_t node, std::uint32_t slot,
                         const LeafRecipe& recipe);

/// Makes leaves whose boxes in the parents are near, and whose moved boxes are apart: the traversal
/// spends the most work on their pair, and does not list it.
void make_apart(TreeMaker& a, std::uint32_t first_a, TreeMaker& b, std::uint32_t first_b,
                std::uint32_t slot);

/// Makes a leaf of b that is far from every leaf of a.
void make_alone(TreeMaker& b, std::uint32_t first_b, std::uint32_t slot);

/// Makes a full leaf in the first slot, for any child.
void make_stacked(TreeMaker& tree, std::uint32_t node);

}  // namespace axg
