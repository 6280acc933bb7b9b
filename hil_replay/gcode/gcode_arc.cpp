// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_arc.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kTwoPi = 2.0 * kPi;
constexpr double kAngleTiny = 1e-12;  // rad: a start and end on one ray are a full turn
constexpr double kRadiusMmMin = 1e-6;
constexpr double kRadiusMmMax = 1e6;

std::string print(const char* format, double a, double b) {
    char text[160];
    std::snprintf(text, sizeof text, format, a, b);
    return text;
}

/// R form: computes the centre on the chord's bisector, on the side that gives the short arc, or
/// for a negative R the long arc.
bool center_from_radius(const ArcWords& words, double tolerance, ArcShape& shape) {
    const double chord_first = words.end_first - words.start_first;
    const double chord_second = words.end_second - words.start_second;
    const double half = std::hypot(chord_first, chord_second) / 2;
    const double radius = std::abs(words.radius);
    if (half < kRadiusMmMin) {
        shape.fault = "a full circle has no R form; give the centre with I J K";
        return false;
    }
    if (half - radius > tolerance) {
        shape.fault =
            print("radius %.6g mm is too small to reach the end point (expected %.6g or more)",
                  radius, half);
        return false;
    }
    const double height = radius > half ? std::sqrt((radius - half) * (radius + half)) : 0.0;
    // The centre of a short counter-clockwise arc is to the left of the chord.
    const double side = (words.is_clockwise ? -1.0 : 1.0) * (words.radius < 0 ? -1.0 : 1.0);
    shape.center_first =
        (words.start_first + words.end_first) / 2 - side * height * chord_second / (2 * half);
    shape.center_second =
        (words.start_second + words.end_second) / 2 + side * height * chord_first / (2 * half);
    return true;
}

}  // namespace

ArcShape solve_arc(const ArcWords& words) {
    ArcShape shape;
    const double unit = words.is_inch ? 25.4 / 10.0 : 1.0;  // 0.0005 in is a tenth of 0.005 unit
    const double tolerance = 0.005 * unit;
    if (words.has_radius) {
        if (!center_from_radius(words, tolerance, shape)) {
            return shape;
        }
    } else {
        shape.center_first = words.center_first;
        shape.center_second = words.center_second;
    }
    const double start_first = words.start_first - shape.center_first;
    const double start_second = words.start_second - shape.center_second;
    const double end_first = words.end_first - shape.center_first;
    const double end_second = words.end_second - shape.center_second;
    shape.radius_start = std::hypot(start_first, start_second);
    shape.radius_end = std::hypot(end_first, end_second);
    const double error = std::abs(shape.radius_start - shape.radius_end);
    const double larger = std::max(shape.radius_start, shape.radius_end);
    if (std::min(shape.radius_start, shape.radius_end) < kRadiusMmMin || larger > kRadiusMmMax) {
        shape.fault =
            print("radius %.6g mm at the start, %.6g at the end: not a circle; check I J K",
                  shape.radius_start, shape.radius_end);
        return shape;
    }
    if (error > 100 * tolerance || (error > tolerance && error > 0.001 * larger)) {
        shape.fault = print(
            "does not close: radius %.6g mm at the start, %.6g at the end; check I J K and the end",
            shape.radius_start, shape.radius_end);
        return shape;
    }
    shape.start_rad = std::atan2(start_second, start_first);
    double sweep = std::atan2(start_first * end_second - start_second * end_first,
                              start_first * end_first + start_second * end_second);
    if (words.is_clockwise) {
        sweep = sweep > -kAngleTiny ? sweep - kTwoPi : sweep;
    } else {
        sweep = sweep < kAngleTiny ? sweep + kTwoPi : sweep;
    }
    shape.sweep_rad = sweep + (words.is_clockwise ? -1 : 1) * kTwoPi * (words.turns - 1);
    return shape;
}

}  // namespace axg
