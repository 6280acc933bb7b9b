// SPDX-License-Identifier: Apache-2.0
// How often a surface winds around a point, by libm: a judge that shares no code with core/winding.
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "core/base/vec3.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::test {

/// By solid angles: 0 outside, 1 inside, but for roundings; in between on the surface.
inline double solid_angle_winding(std::span<const Triangle> mesh, Vec3d p) {
    double sum = 0;
    for (const Triangle& t : mesh) {
        const Vec3d a = widen(t.a) - p, b = widen(t.b) - p, c = widen(t.c) - p;
        const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)),
                     lc = std::sqrt(dot(c, c));
        sum += 2 * std::atan2(dot(a, cross(b, c)),
                              la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace axg::test
