// SPDX-License-Identifier: Apache-2.0
// Triangles in another frame.
#pragma once

#include <span>

#include "core/base/pose.hpp"
#include "core/base/vec3.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// Moves each corner by `at`, in double, and rounds it to float32 once: off by at most 2^-24 of its
/// largest coordinate, mm.
inline void place_triangles(const Pose& at, std::span<Triangle> triangles) noexcept {
    for (Triangle& triangle : triangles) {
        for (Vec3f* corner : {&triangle.a, &triangle.b, &triangle.c}) {
            const Vec3d p = apply(at, widen(*corner));
            *corner = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        }
    }
}

}  // namespace axg
