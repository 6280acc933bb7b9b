// SPDX-License-Identifier: Apache-2.0
// A body's surface as triangles, float32 mm in the body's own frame: these numbers are the body,
// exactly.
#pragma once

#include <string>
#include <vector>

#include "core/vec3.hpp"

namespace axg {

struct Triangle {
    Vec3f a, b, c;

    friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

struct Mesh {
    std::string name;
    std::vector<Triangle> triangles;
};

}  // namespace axg
