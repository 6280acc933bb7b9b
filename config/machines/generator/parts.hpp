// SPDX-License-Identifier: Apache-2.0
// The parts of the example machines, mm, each in the mesh frame that its machine file places.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg::generator {

struct Part {
    std::string file;  // beneath the output folder
    std::vector<Triangle> triangles;
};

[[nodiscard]] std::vector<Part> paper_trunnion();
[[nodiscard]] std::vector<Part> spindle_tilting();
[[nodiscard]] std::vector<Part> table_spindle_tilting();

}  // namespace axg::generator
