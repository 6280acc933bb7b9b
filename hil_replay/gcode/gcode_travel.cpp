// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_travel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr const char* kAdvice =
    "; change the program, or state the control's offset with --work-offset";

struct Extent {
    double low, high;
};

/// Whether the swept angle passes `angle_rad`, modulo whole turns.
bool passes(const Arc& arc, double angle_rad) {
    constexpr double kTwoPi = 2.0 * kPi;
    const double turn = std::fmod(angle_rad - arc.start_rad, kTwoPi);
    const double ahead =
        arc.sweep_rad > 0 ? (turn < 0 ? turn + kTwoPi : turn) : (turn > 0 ? turn - kTwoPi : turn);
    return std::abs(ahead) <= std::abs(arc.sweep_rad);
}

/// Ends of the move along one axis. The larger radius of a spiral bounds it from outside.
Extent extent_of(const Move& move, std::uint32_t axis) {
    Extent extent{move.target[axis], move.target[axis]};  // the start was checked before
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

/// Ends of the travel; for an endless axis, the largest positions that the code can process.
Extent travel_of(const Axis& axis) {
    const double bound = axis.kind == AxisKind::rotary ? kSinCosArgumentMax : kCoordinateMmMax;
    return axis.unlimited ? Extent{-bound, bound} : Extent{axis.min, axis.max};
}

void add_excess(const Machine& machine, std::uint32_t axis, const Extent& extent,
                std::vector<TravelExcess>& out) {
    const Extent travel = travel_of(machine.axes[axis]);
    if (!(extent.low >= travel.low - kTravelSlack)) {
        out.push_back({axis, true, extent.low});
    }
    if (!(extent.high <= travel.high + kTravelSlack)) {
        out.push_back({axis, false, extent.high});
    }
}

/// The commanded position at a share of the move.
AxisPositions point_on(const AxisPositions& from, const Move& move, double share) {
    AxisPositions at;
    for (std::size_t i = 0; i < at.size(); ++i) {
        at[i] = from[i] + (move.target[i] - from[i]) * share;
    }
    const Arc& arc = move.arc;
    if (move.kind == MoveKind::arc) {
        const SinCos angle = sin_cos(arc.start_rad + arc.sweep_rad * share);
        const double radius =
            arc.radius_start_mm + (arc.radius_end_mm - arc.radius_start_mm) * share;
        at[arc.first] = arc.center_first_mm + radius * angle.cos;
        at[arc.second] = arc.center_second_mm + radius * angle.sin;
    }
    return at;
}

}  // namespace

std::vector<TravelExcess> check_controlled_travel(const Machine& machine, const TipControl& control,
                                                  const AxisPositions& from, const Move& move,
                                                  bool& is_singular) {
    constexpr double kStepRad = 0.25 * kPi / 180;
    constexpr double kStepsMax = 1e7;
    double turning = std::abs(move.kind == MoveKind::arc ? move.arc.sweep_rad : 0.0);
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        const bool is_rotary = machine.axes[i].kind == AxisKind::rotary;
        turning += is_rotary ? std::abs(move.target[i] - from[i]) : 0.0;
    }
    const auto steps =
        static_cast<std::uint32_t>(std::min(kStepsMax, std::ceil(turning / kStepRad) + 1));
    std::array<Extent, kAxesMax> extents;
    extents.fill({HUGE_VAL, -HUGE_VAL});
    is_singular = false;
    for (std::uint32_t step = 1; step <= steps; ++step) {
        const AxisPositions commanded = point_on(from, move, static_cast<double>(step) / steps);
        is_singular = is_singular || !(control.spread_at(commanded) >= kSpreadMin);
        AxisPositions axes;
        control.axes_at(commanded, axes);
        for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
            extents[i].low = std::min(extents[i].low, axes[i]);
            extents[i].high = std::max(extents[i].high, axes[i]);
        }
    }
    std::vector<TravelExcess> out;
    for (std::uint32_t i = 0; i < machine.axes.size() && !is_singular; ++i) {
        if (control.is_tip_axis(i) || move.target[i] != from[i]) {
            add_excess(machine, i, extents[i], out);
        }
    }
    return out;
}

std::vector<TravelExcess> check_travel(const Machine& machine, const AxisPositions& from,
                                       const Move& move) {
    std::vector<TravelExcess> out;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        if (move.target[i] == from[i] && move.kind == MoveKind::line) {
            continue;  // checked with the move that ended there
        }
        add_excess(machine, i, extent_of(move, i), out);
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

void TravelWatch::check(const Machine& machine, const Program& program, const AxisPositions& from,
                        const Move& move, std::vector<ProgramFault>& faults) {
    bool is_singular = false;
    const std::vector<TravelExcess> excesses =
        move.control == kNoIndex ? check_travel(machine, from, move)
                                 : check_controlled_travel(machine, program.controls[move.control],
                                                           from, move, is_singular);
    if (is_singular && !was_singular_) {
        faults.push_back({move.line, "tool centre point control",
                          "singular: with the rotary axes as they are somewhere in this move X, Y "
                          "and Z no longer move the tip in all directions; turn them elsewhere"});
    }
    was_singular_ = was_singular_ || is_singular;
    for (const TravelExcess& excess : excesses) {
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
