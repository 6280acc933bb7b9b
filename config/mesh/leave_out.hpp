// SPDX-License-Identifier: Apache-2.0
// Triangles that a surface goes on without.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg {

/// Leaves out the triangles with these indices, in any order; the others stay in theirs.
inline void leave_out(std::span<const std::uint32_t> indices, std::vector<Triangle>& triangles) {
    std::vector<char> is_left_out(triangles.size(), 0);
    for (const std::uint32_t i : indices) {
        is_left_out[i] = 1;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (is_left_out[i] == 0) {
            triangles[kept++] = triangles[i];
        }
    }
    triangles.resize(kept);
}

}  // namespace axg
