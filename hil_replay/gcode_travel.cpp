// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode_travel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/sincos.hpp"

namespace axg {
namespace {

struct Extent {
    double low, high;
};

/// True when the swept angle passes `angle_rad`, whole turns apart.
bool passes(const Arc& arc, double angle_rad) {
    constexpr double kTwoPi = 2.0 * kPi;
    const double turn = std::fmod(angle_rad - arc.start_rad, kTwoPi);
    const double ahead =
        arc.sweep_rad > 0 ? (turn < 0 ? turn + kTwoPi : turn) : (turn > 0 ? turn - kTwoPi : turn);
    return std::abs(ahead) <= std::abs(arc.sweep_rad);
}

/// Ends of the move along one axis. An arc's largest radius bounds a spiral from outside.
Extent extent_of(const Move& move, std::uint32_t axis) {
    Extent extent{move.target[axis], move.target[axis]};  // where it starts was checked before
    const Arc& arc = move.arc;
    if (move.kind != MoveKind::arc || (axis != arc.first && axis != arc.second)) {
        return extent;
    }
    const double radius = std::max(arc.radius_start_mm, arc.radius_end_mm);
    const double center = axis == arc.first ? arc.center_first_mm : arc.center_second_mm;
    const double high_angle = axis == arc.first ? 0.0 : kPi / 2;
    if (passes(arc, high_angle)) {
        extent.high = std::max(extent.high, center + radius);
    }
    if (passes(arc, high_angle + kPi)) {
        extent.low = std::min(extent.low, center - radius);
    }
    return extent;
}

std::string describe(const Axis& axis, double value, const char* which, double limit) {
    const bool is_rotary = axis.kind == AxisKind::rotary;
    const double factor = is_rotary ? 180.0 / kPi : 1.0;
    const char* unit = is_rotary ? "deg" : "mm";
    char text[240];
    std::snprintf(text, sizeof text,
                  "out of travel: goes to %.6g %s, %s is %.6g %s (machine coordinates); change the "
                  "program, or state the control's offset with --work-offset",
                  value * factor, unit, which, limit * factor, unit);
    return text;
}

}  // namespace

void check_travel(const Machine& machine, const AxisPositions& from, const Move& move,
                  std::vector<ProgramFault>& faults) {
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double bound = axis.kind == AxisKind::rotary ? kSinCosArgumentMax : kCoordinateMmMax;
        const double low = axis.unlimited ? -bound : axis.min;
        const double high = axis.unlimited ? bound : axis.max;
        const Extent extent = extent_of(move, i);
        if (move.target[i] == from[i] && move.kind == MoveKind::line) {
            continue;  // reported already, by the move that went there
        }
        if (!(extent.low >= low - kTravelSlack)) {
            faults.push_back(
                {move.line, axis.name, describe(axis, extent.low, "the lower end", low)});
        }
        if (!(extent.high <= high + kTravelSlack)) {
            faults.push_back(
                {move.line, axis.name, describe(axis, extent.high, "the upper end", high)});
        }
    }
}

}  // namespace axg
