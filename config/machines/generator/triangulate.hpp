// SPDX-License-Identifier: Apache-2.0
// A polygon with holes into triangles over its own corners.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace axg::generator {

struct Point {
    double x, y;

    friend bool operator==(const Point&, const Point&) = default;
};

/// @param point  all corners
/// @param loops  the outer loop counter-clockwise, then the holes clockwise; simple, disjoint
/// @return       corners + 2 holes - 2 triangles, counter-clockwise; empty when the loops are not
/// as promised Cost: about cubic: for parts of a few hundred corners, at build time.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(
    const std::vector<Point>& point, const std::vector<std::vector<std::uint32_t>>& loops);

}  // namespace axg::generator
