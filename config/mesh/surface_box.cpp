// SPDX-License-Identifier: Apache-2.0
#include "config/mesh/surface_box.hpp"

#include <algorithm>
#include <vector>

#include "config/mesh/survey_mesh.hpp"

namespace axg {

SurfaceBox box_of(std::span<const Triangle> triangles, const Pose& at) {
    SurfaceBox box;
    bool is_first = true;
    for (const Triangle& triangle : triangles) {
        for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) {
            const Vec3d p = apply(at, widen(corner));
            box.low_mm = is_first ? p
                                  : Vec3d{std::min(box.low_mm.x, p.x), std::min(box.low_mm.y, p.y),
                                          std::min(box.low_mm.z, p.z)};
            box.high_mm = is_first
                              ? p
                              : Vec3d{std::max(box.high_mm.x, p.x), std::max(box.high_mm.y, p.y),
                                      std::max(box.high_mm.z, p.z)};
            is_first = false;
        }
    }
    return box;
}

double longest_side(Vec3d size_mm) noexcept {
    return std::max({size_mm.x, size_mm.y, size_mm.z});
}

double scale_between(LengthUnit from, LengthUnit to) noexcept {
    return length_of(to) / length_of(from);
}

double median_side(std::span<const double> sides_mm) {
    std::vector<double> sides(sides_mm.begin(), sides_mm.end());
    std::sort(sides.begin(), sides.end());
    return sides.empty() ? 0 : sides[sides.size() / 2];
}

}  // namespace axg
