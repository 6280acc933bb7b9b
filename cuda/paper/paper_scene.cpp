// SPDX-License-Identifier: Apache-2.0
#include "cuda/paper/paper_scene.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/collision/tree.hpp"

namespace axg::paper {
namespace {

/// The box around some triangles of a body, half widths rounded up past their own rounding.
SubBox box_around(const std::vector<Triangle>& triangles, std::uint32_t first,
                  std::uint32_t count) {
    SubBox box{};
    box.first = first, box.count = count;
    for (int k = 0; k < 3; ++k) {
        float low = INFINITY, high = -INFINITY;
        for (std::uint32_t i = first; i < first + count; ++i) {
            const Triangle& t = triangles[i];
            for (const Vec3f& v : {t.a, t.b, t.c}) {
                const float x = k == 0 ? v.x : k == 1 ? v.y : v.z;
                low = std::min(low, x), high = std::max(high, x);
            }
        }
        box.c[k] = 0.5F * (low + high);
        const float half = std::max(high - box.c[k], box.c[k] - low);
        box.h[k] = std::nextafter(half, INFINITY);
    }
    return box;
}

}  // namespace

Body make_body(std::span<const Triangle> triangles) {
    Body body;
    const TreeData tree = build_tree(triangles);
    for (const TreeNode& node : tree.nodes) {
        if (node.leaf == kNoLeaf) {
            continue;
        }
        const auto first = static_cast<std::uint32_t>(body.triangles.size());
        for (std::uint32_t i = 0; i < node.count; ++i) {
            body.triangles.push_back(triangles[tree.leaves[node.leaf].triangle[i]]);
        }
        body.boxes.push_back(box_around(body.triangles, first, node.count));
    }
    const auto count = static_cast<std::uint32_t>(body.triangles.size());
    AXG_ASSERT(count == triangles.size());
    for (std::uint32_t first = 0; first < count; first += kNodeWidth) {
        body.tiles.push_back(
            box_around(body.triangles, first, std::min(kNodeWidth, count - first)));
    }
    body.whole = box_around(body.triangles, 0, count);
    for (const Triangle& t : triangles) {
        for (const Vec3f& v : {t.a, t.b, t.c}) {
            body.reach_mm =
                std::max({body.reach_mm, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
        }
    }
    return body;
}

}  // namespace axg::paper
