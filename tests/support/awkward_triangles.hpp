// SPDX-License-Identifier: Apache-2.0
// Triangles without area, needles, and next to nothing: what a separating axis can stumble over.
#pragma once

#include "tests/support/random_queries.hpp"

namespace axg::test {

/// @param kind  0: of usual size on few whole coordinates; 1: next to no size; 2: large
inline Mesh awkward_triangles(Draw& draw, std::uint32_t kind) {
    Mesh mesh{"awkward", {}};
    const float size = kind == 0 ? 20.0F : kind == 1 ? 0x1p-140F : 300.0F;
    const auto vertex = [&](float s) {
        const auto x = [&] { return s * static_cast<float>(static_cast<int>(draw.below(9)) - 4); };
        return Vec3f{x(), x(), x()};
    };
    const std::uint32_t count = 1 + draw.below(400);
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3f at = vertex(size), to = at + vertex(size * 0.25F);
        const Vec3f third = draw.below(3) == 0 ? to : at + vertex(size * 0.25F);
        mesh.triangles.push_back({at, draw.below(9) == 0 ? at : to, third});
    }
    return mesh;
}

}  // namespace axg::test
