// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certcheck/box_tree.hpp"

#include <algorithm>

namespace axg::certcheck {
namespace {

Vector box_of(const Triangle* first, std::uint32_t count) {
    Vector box{{first[0][0], first[0][1], first[0][2]}};
    for (std::uint32_t i = 0; i < 9 * count; ++i) {
        const double value = first[i / 9][i % 9];
        box[i % 3] = {std::min(box[i % 3].low, value), std::max(box[i % 3].high, value)};
    }
    return box;
}

}  // namespace

BoxTree::BoxTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    std::vector<TreeNode> open;
    if (!triangles_.empty()) {
        boxes_.resize(2 * triangles_.size() - 1);
        open.push_back(top());
    }
    while (!open.empty()) {
        const TreeNode node = open.back();
        open.pop_back();
        Triangle* first = triangles_.data() + node.first;
        const Vector& box = boxes_[node.index] = box_of(first, node.count);
        if (node.count == 1) {
            continue;
        }
        std::size_t widest = 0;
        for (std::size_t i = 1; i < 3; ++i) {
            if (box[i].high - box[i].low > box[widest].high - box[widest].low) {
                widest = i;
            }
        }
        const auto middle = [widest](const Triangle& t) {
            return t[widest] + t[widest + 3] + t[widest + 6];
        };
        std::nth_element(
            first, first + node.count / 2, first + node.count,
            [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
        open.push_back(node.lower());
        open.push_back(node.upper());
    }
}

}  // namespace axg::certcheck
