// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode_travel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/sincos.hpp"

namespace axg {
namespace {

constexpr const char* kAdvice =
    "; change the program, or state the control's offset with --work-offset";

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

/// "301 mm"
std::string value_text(const Axis& axis, double value) {
    const bool is_rotary = axis.kind == AxisKind::rotary;
    char text[40];
    std::snprintf(text, sizeof text, "%.6g %s", value * (is_rotary ? 180.0 / kPi : 1.0),
                  is_rotary ? "deg" : "mm");
    return text;
}

/// Ends of the travel; of an endless axis, what can be computed with.
Extent travel_of(const Axis& axis) {
    const double bound = axis.kind == AxisKind::rotary ? kSinCosArgumentMax : kCoordinateMmMax;
    return axis.unlimited ? Extent{-bound, bound} : Extent{axis.min, axis.max};
}

}  // namespace

std::vector<TravelExcess> check_travel(const Machine& machine, const AxisPositions& from,
                                       const Move& move) {
    std::vector<TravelExcess> out;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        if (move.target[i] == from[i] && move.kind == MoveKind::line) {
            continue;  // reported already, by the move that went there
        }
        const Extent travel = travel_of(machine.axes[i]);
        const Extent extent = extent_of(move, i);
        if (!(extent.low >= travel.low - kTravelSlack)) {
            out.push_back({i, true, extent.low});
        }
        if (!(extent.high <= travel.high + kTravelSlack)) {
            out.push_back({i, false, extent.high});
        }
    }
    return out;
}

std::string describe_excess(const Machine& machine, const TravelExcess& excess) {
    const Axis& axis = machine.axes[excess.axis];
    const Extent travel = travel_of(axis);
    return "out of travel: goes to " + value_text(axis, excess.value) + ", the " +
           (excess.is_low ? "lower" : "upper") + " end is " +
           value_text(axis, excess.is_low ? travel.low : travel.high) + " (machine coordinates)";
}

void TravelWatch::check(const Machine& machine, const AxisPositions& from, const Move& move,
                        std::vector<ProgramFault>& faults) {
    for (const TravelExcess& excess : check_travel(machine, from, move)) {
        const Axis& axis = machine.axes[excess.axis];
        const auto seen = std::find_if(seen_.begin(), seen_.end(), [&excess](const Seen& one) {
            return one.first.axis == excess.axis && one.first.is_low == excess.is_low;
        });
        if (seen == seen_.end()) {
            seen_.push_back({excess, excess, faults.size(), 0, move.line});
            faults.push_back({move.line, axis.name, describe_excess(machine, excess) + kAdvice});
            continue;
        }
        ++seen->more;
        const bool is_farther = excess.is_low ? excess.value < seen->farthest.value
                                              : excess.value > seen->farthest.value;
        if (is_farther) {
            seen->farthest = excess;
            seen->line = move.line;
        }
        faults[seen->fault].message =
            describe_excess(machine, seen->first) + kAdvice + "; " + std::to_string(seen->more) +
            (seen->more == 1 ? " more move" : " more moves") + ", the farthest in line " +
            std::to_string(seen->line) + " to " + value_text(axis, seen->farthest.value);
    }
}

}  // namespace axg
