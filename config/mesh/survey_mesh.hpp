// SPDX-License-Identifier: Apache-2.0
// A first look at a mesh that no machine file names yet: its size, and what would have to be
// allowed for it.
#pragma once

#include <string>
#include <vector>

#include "core/machine/machine.hpp"

namespace axg {

struct SurveyedMesh {
    MeshSource source;     // file, unit, size, and the fewest allow_ marks under which it loads
    Vec3d min_mm, max_mm;  // bounding box
    std::vector<std::string>
        faults;  // what no mark allows: such a mesh cannot be used before it is repaired
    std::vector<std::string> notes;  // the oddities that the marks allow
};

/// @param root  folder; `file` may not leave it
[[nodiscard]] SurveyedMesh survey_mesh(const std::string& root, const std::string& file,
                                       LengthUnit unit);

/// Length of a unit in mm, and its name in a machine file.
[[nodiscard]] double length_of(LengthUnit unit) noexcept;
[[nodiscard]] const char* name_of(LengthUnit unit) noexcept;

}  // namespace axg
