// SPDX-License-Identifier: Apache-2.0
// Points and ways in the plane of arcs.
#pragma once

#include <cmath>

namespace axg {

/// A point or a way in the plane, mm; in splines the program's unit.
struct PlanePoint {
    double first = 0, second = 0;
};

inline PlanePoint operator+(PlanePoint a, PlanePoint b) noexcept {
    return {a.first + b.first, a.second + b.second};
}
inline PlanePoint operator-(PlanePoint a, PlanePoint b) noexcept {
    return {a.first - b.first, a.second - b.second};
}
inline PlanePoint operator*(double factor, PlanePoint a) noexcept {
    return {factor * a.first, factor * a.second};
}
inline double dot(PlanePoint a, PlanePoint b) noexcept {
    return a.first * b.first + a.second * b.second;
}
inline double length(PlanePoint a) noexcept {
    return std::hypot(a.first, a.second);
}

}  // namespace axg
