// SPDX-License-Identifier: Apache-2.0
// Closed round bodies that face outwards, and turns of them that keep whole numbers whole.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "tests/support/solids.hpp"

namespace axg::test {

/// A ball of 12 n^2 triangles: the cube's grid blown up. Corners on a grid of `step_mm` where that
/// is not 0.
inline Triangles ball(std::uint32_t n, double radius_mm, double step_mm = 0) {
    const auto vertex = [=](double x, double y, double z) {
        const double size = radius_mm / std::sqrt(x * x + y * y + z * z);
        const auto at = [=](double c) {
            const double mm = size * c;
            return static_cast<float>(step_mm == 0 ? mm : step_mm * std::nearbyint(mm / step_mm));
        };
        return Vec3f{at(x), at(y), at(z)};
    };
    Triangles out;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const auto corner = [&](std::uint32_t u, std::uint32_t v) {
                double p[3];
                p[axis] = side;
                p[(axis + 1) % 3] = side * (2.0 * u / n - 1);  // mirrored twice: faces outwards
                p[(axis + 2) % 3] = 2.0 * v / n - 1;
                return vertex(p[0], p[1], p[2]);
            };
            for (std::uint32_t u = 0; u < n; ++u) {
                for (std::uint32_t v = 0; v < n; ++v) {
                    out.push_back({corner(u, v), corner(u + 1, v), corner(u + 1, v + 1)});
                    out.push_back({corner(u, v), corner(u + 1, v + 1), corner(u, v + 1)});
                }
            }
        }
    }
    return out;
}

/// A ring about z: 2 * around * across triangles.
inline Triangles ring(std::uint32_t around, std::uint32_t across, double radius_mm,
                      double tube_mm) {
    constexpr double kTurn = 6.283185307179586;
    const auto at = [=](std::uint32_t u, std::uint32_t v) {
        const double a = kTurn * (u % around) / around, b = kTurn * (v % across) / across;
        const double r = radius_mm + tube_mm * std::cos(b);
        return Vec3f{static_cast<float>(r * std::cos(a)), static_cast<float>(r * std::sin(a)),
                     static_cast<float>(tube_mm * std::sin(b))};
    };
    Triangles out;
    for (std::uint32_t u = 0; u < around; ++u) {
        for (std::uint32_t v = 0; v < across; ++v) {
            out.push_back({at(u, v), at(u + 1, v), at(u + 1, v + 1)});
            out.push_back({at(u, v), at(u + 1, v + 1), at(u, v + 1)});
        }
    }
    return out;
}

/// Turns the axes in a circle, `times` times: x becomes y, y becomes z.
inline Vec3f turned_axes(Vec3f p, int times) {
    for (int i = 0; i < times; ++i) {
        p = {p.z, p.x, p.y};
    }
    return p;
}
inline Triangles turned_axes(Triangles triangles, int times) {
    for (Triangle& t : triangles) {
        t = {turned_axes(t.a, times), turned_axes(t.b, times), turned_axes(t.c, times)};
    }
    return triangles;
}

}  // namespace axg::test
