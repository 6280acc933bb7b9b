// SPDX-License-Identifier: Apache-2.0
// Boxes over the triangles of a surface, halved at the median down to single triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hil_replay/certcheck/interval.hpp"

namespace axg::certcheck {

using Triangle = std::array<float, 9>;  // corners a, b, c

/// The triangles [first, first + count) below node `index`; its children have the nodes index + 1
/// and index + 2 (count / 2), for a tree over n triangles has 2 n - 1 nodes, parents first.
struct TreeNode {
    std::uint32_t index, first, count;

    [[nodiscard]] TreeNode lower() const { return {index + 1, first, count / 2}; }
    [[nodiscard]] TreeNode upper() const {
        return {index + 2 * (count / 2), first + count / 2, count - count / 2};
    }
};

class BoxTree {
  public:
    BoxTree() = default;
    explicit BoxTree(std::vector<Triangle> triangles);

    [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
    [[nodiscard]] TreeNode top() const {
        return {0, 0, static_cast<std::uint32_t>(triangles_.size())};
    }
    [[nodiscard]] const Vector& box(TreeNode node) const { return boxes_[node.index]; }
    [[nodiscard]] const Triangle& triangle(TreeNode leaf) const { return triangles_[leaf.first]; }

  private:
    std::vector<Triangle> triangles_;  // in the order of the leaves
    std::vector<Vector> boxes_;        // exact bounds
};

}  // namespace axg::certcheck
