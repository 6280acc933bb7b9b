// SPDX-License-Identifier: Apache-2.0
// Bodies as the CUDA engine takes them when they need not come from meshes. mm.
#pragma once

#include <cstdint>
#include <vector>

#include "core/collision/tree.hpp"

namespace axg::cuda {

struct TreeBodies {
    std::vector<TreeData> trees;
    std::vector<float> reach_mm;    // largest |coordinate| of each
    std::uint32_t tree_levels = 1;  // of pairs of nodes that two of them may take to open
};

}  // namespace axg::cuda
