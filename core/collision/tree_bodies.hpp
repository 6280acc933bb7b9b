// SPDX-License-Identifier: Apache-2.0
// Bodies as trees, for an engine whose bodies need not come from meshes. mm.
#pragma once

#include <cstdint>
#include <vector>

#include "core/collision/tree.hpp"

namespace axg {

struct TreeBodies {
    std::vector<TreeData> trees;
    std::vector<float> reach_mm;    // largest |coordinate| of each
    std::uint32_t tree_levels = 1;  // of pairs of nodes that two of them may take to open
};

}  // namespace axg
