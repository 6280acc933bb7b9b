// SPDX-License-Identifier: Apache-2.0
// Removes triangles from a surface by index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg {

/// Removes the triangles with these indices, in any order; the others stay in theirs.
inline void prune(std::span<const std::uint32_t> indices, std::vector<Triangle>& triangles) {
    std::vector<char> is_pruned(triangles.size(), 0);
    for (const std::uint32_t i : indices) {
        is_pruned[i] = 1;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (is_pruned[i] == 0) {
            triangles[kept++] = triangles[i];
        }
    }
    triangles.resize(kept);
}

}  // namespace axg
