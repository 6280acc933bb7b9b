// SPDX-License-Identifier: Apache-2.0
#include "core/mesh/shape.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "core/base/sincos.hpp"
#include "core/mesh/place_triangles.hpp"
#include "core/mesh/swept_profile.hpp"

namespace axg {
namespace {

// More than the rounding of sine, cosine and the points to float32.
constexpr double kGuard = 1.0e-6;

std::vector<Triangle> box_triangles(const Vec3d& size) {
    // Corner i: bit 0 means larger x, bit 1 larger y, bit 2 larger z. Two triangles a side,
    // counter-clockwise seen from outside.
    constexpr std::array<std::array<std::uint8_t, 3>, 12> kSides{{{0, 2, 3},
                                                                  {0, 3, 1},
                                                                  {4, 5, 7},
                                                                  {4, 7, 6},
                                                                  {0, 1, 5},
                                                                  {0, 5, 4},
                                                                  {2, 6, 7},
                                                                  {2, 7, 3},
                                                                  {0, 4, 6},
                                                                  {0, 6, 2},
                                                                  {1, 3, 7},
                                                                  {1, 7, 5}}};
    const auto corner = [&size](unsigned i) {
        return Vec3f{static_cast<float>((i & 1U) != 0 ? 0.5 * size.x : -0.5 * size.x),
                     static_cast<float>((i & 2U) != 0 ? 0.5 * size.y : -0.5 * size.y),
                     static_cast<float>((i & 4U) != 0 ? size.z : 0.0)};
    };
    std::vector<Triangle> out;
    for (const auto& side : kSides) {
        out.push_back({corner(side[0]), corner(side[1]), corner(side[2])});
    }
    return out;
}

/// Whether a turn about +Z leaves the shape unchanged.
bool is_about_z(const Shape& shape) noexcept {
    const Pose& at = shape.at;
    return !shape.profile.empty() && at.r[0][2] == 0 && at.r[1][2] == 0 && at.t[0] == 0 &&
           at.t[1] == 0;
}

}  // namespace

std::vector<Vec3d> cone_profile(double radius_mm, double top_radius_mm, double height_mm) {
    std::vector<Vec3d> out{{0, 0, 0}, {radius_mm, 0, 0}};
    if (top_radius_mm > 0) {
        out.push_back({top_radius_mm, 0, height_mm});
    }
    out.push_back({0, 0, height_mm});
    return out;
}

std::vector<Vec3d> sphere_profile(double radius_mm, std::uint32_t segments) {
    const std::uint32_t sides = (segments + 1) / 2;  // from pole to pole
    const double step = kPi / static_cast<double>(sides);
    const double corner_mm = radius_mm / sin_cos(0.5 * step).cos * (1 + kGuard);
    std::vector<Vec3d> out;
    for (std::uint32_t i = 0; i <= sides; ++i) {
        const SinCos angle = sin_cos(step * static_cast<double>(i));
        const bool is_pole = i == 0 || i == sides;
        out.push_back({is_pole ? 0.0 : corner_mm * angle.sin, 0, -corner_mm * angle.cos});
    }
    return out;
}

RevolutionResult triangles_of(const Shape& shape) {
    RevolutionResult out;
    if (shape.profile.empty()) {
        out.triangles = box_triangles(shape.box_mm);
    } else {
        out = solid_of_revolution(shape.profile, shape.segments);
    }
    place_triangles(shape.at, out.triangles);
    if (shape.turns && out.status == RevolutionStatus::ok && !is_about_z(shape)) {
        out = swept_solid(out.triangles);
    }
    return out;
}

}  // namespace axg
