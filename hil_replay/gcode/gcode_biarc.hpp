// SPDX-License-Identifier: Apache-2.0
// Converts control points to the arcs and lines along which LinuxCNC moves: not to the curve itself
// but to pairs of arcs through samples of it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace axg {

inline constexpr std::uint32_t kSplineOrderMin = 3, kSplineOrderMax = 10;

/// In the plane's own two coordinates and the program's unit.
struct SplinePoint {
    double first = 0, second = 0;
    double weight = 1;
};

/// Begins where the piece before it ends.
struct SplinePiece {
    double end_first = 0, end_second = 0;
    bool is_arc = false;
    double center_first = 0, center_second = 0;
    bool is_clockwise = false;
};

struct SplineShape {
    std::vector<SplinePiece> pieces;  // eight for each control point
    std::string fault;                // empty: usable
};

/// A rational B-spline with knots 0 (order times), 1, 2, ... and its last knot (order times). The
/// two others are such splines with as many points as their order: G5.1 three, G5 four.
/// @param points  at least `order`, weights above 0
/// Source of the path: LinuxCNC 2.9, emccanon.cc, NURBS_FEED. It takes the curve at four parameters
/// for each control point, with tangents by differences, and joins two of them by two arcs.
[[nodiscard]] SplineShape solve_spline(std::span<const SplinePoint> points, std::uint32_t order);

/// The curve itself, at a parameter from 0 to points.size() - order + 1.
[[nodiscard]] SplinePoint spline_at(std::span<const SplinePoint> points, std::uint32_t order,
                                    double parameter);

}  // namespace axg
