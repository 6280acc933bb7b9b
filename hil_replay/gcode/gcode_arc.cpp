// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_arc.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_state.hpp"

namespace axg {
namespace {

constexpr double kTwoPi = 2.0 * kPi;
// LinuxCNC's kSamePlaceMm is in the machine's unit: between that of the mm and that of the inch,
// rounded up, the answer depends on the unit and on rounding.
constexpr double kApartMm = 1e-6;
constexpr double kChordMmMin = 1e-6;
// LinuxCNC 2.9, interp_internal.hh, RADIUS_TOLERANCE_MM: a smaller radius is none, and R may be too
// small by it.
constexpr double kRadiusMmMin = 0.00127;
constexpr double kRadiusMmMax = 1e6;
constexpr double kRelativeTolerance = 0.001, kSpiralFactor = 100;

std::string print(const char* format, double a, double b) {
    char text[160];
    std::snprintf(text, sizeof text, format, a, b);
    return text;
}

/// R form: computes the centre on the chord's bisector, on the side that gives the short arc, or
/// for a negative R the long arc.
bool center_from_radius(const ArcWords& words, ArcShape& shape) {
    const double chord_first = words.end_first - words.start_first;
    const double chord_second = words.end_second - words.start_second;
    const double half = std::hypot(chord_first, chord_second) / 2;
    const double radius = std::abs(words.radius);
    if (half < kChordMmMin) {
        shape.fault = "a full circle has no R form; give the centre with I J K";
        return false;
    }
    if (half - radius > kRadiusMmMin) {
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

/// The signed angle from start to end: a full turn where both are one place. Sets the fault where
/// rounding would decide between a full turn and nothing.
void find_sweep(const ArcWords& words, ArcShape& shape) {
    // Of two nearly equal vectors: their difference has the digits that their product would lose.
    const auto way = [](double from, double to) {
        return std::abs(to - from) < kSamePlaceMm / 10 ? 0.0 : to - from;
    };
    const double way_first = way(words.start_first, words.end_first);
    const double way_second = way(words.start_second, words.end_second);
    const double start_first = words.start_first - shape.center_first;
    const double start_second = words.start_second - shape.center_second;
    const double cross = start_first * way_second - start_second * way_first;
    const double dot = start_first * (start_first + way_first) +  //
                       start_second * (start_second + way_second);
    const double apart_mm = std::hypot(way_first, way_second);
    const double across_mm = std::abs(cross) / std::max(shape.radius_start, shape.radius_end);
    double sweep = apart_mm < kSamePlaceMm ? 0.0 : std::atan2(cross, dot);
    if (sweep != 0 && dot > 0 && across_mm < kApartMm) {
        shape.fault = print(
            "start and end are %.2g mm apart, %.2g mm across the radius: rounding would decide "
            "between a turn and none; leave the end out for a turn",
            apart_mm, across_mm);
        return;
    }
    if (words.is_clockwise) {
        sweep = sweep >= 0 ? sweep - kTwoPi : sweep;
    } else {
        sweep = sweep <= 0 ? sweep + kTwoPi : sweep;
    }
    shape.sweep_rad = sweep + (words.is_clockwise ? -1 : 1) * kTwoPi * (words.turns - 1);
}

}  // namespace

ArcShape solve_arc(const ArcWords& words) {
    ArcShape shape;
    if (words.has_radius) {
        if (!center_from_radius(words, shape)) {
            return shape;
        }
    } else {
        shape.center_first = words.center_first;
        shape.center_second = words.center_second;
    }
    const double start_first = words.start_first - shape.center_first;
    const double start_second = words.start_second - shape.center_second;
    shape.radius_start = std::hypot(start_first, start_second);
    shape.radius_end =
        std::hypot(words.end_first - shape.center_first, words.end_second - shape.center_second);
    const double error = std::abs(shape.radius_start - shape.radius_end);
    const double larger = std::max(shape.radius_start, shape.radius_end);
    if (std::min(shape.radius_start, shape.radius_end) < kRadiusMmMin || larger > kRadiusMmMax) {
        shape.fault =
            print("radius %.6g mm at the start, %.6g at the end: not a circle; check I J K",
                  shape.radius_start, shape.radius_end);
        return shape;
    }
    const double tolerance_mm = std::clamp(kRelativeTolerance * larger, words.tolerance_mm,
                                           kSpiralFactor * words.tolerance_mm);
    if (error > tolerance_mm) {
        shape.fault = print(
            "does not close: the radius at the end differs by %.4g mm, the tolerance is %.4g mm; "
            "check I J K and the end",
            error, tolerance_mm);
        return shape;
    }
    shape.start_rad = std::atan2(start_second, start_first);
    find_sweep(words, shape);
    return shape;
}

}  // namespace axg
