// SPDX-License-Identifier: Apache-2.0
// G5, G5.1, and G5.2 to G5.3: their words, and the moves along them (gcode_biarc.hpp).
// Source: LinuxCNC "G-codes"; interp_convert.cc (2.9), convert_spline and convert_nurbs. Refused is
// what it refuses, and where it moves otherwise than the words say.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {
namespace {

using enum ModalGroup;

constexpr double kRadiusMmMin = 1e-5;  // less: a line is as near
constexpr double kRadiusMmMax = 1e6;   // as of G2 and G3 (gcode_arc.cpp)
constexpr double kFlatMm = 1e-5;       // off a circle that is larger: lines in its place

std::string print(const char* format, double a, double b) {
    char text[160];
    std::snprintf(text, sizeof text, format, a, b);
    return text;
}

/// Whether LinuxCNC's result is the same with this block between G5.2 and G5.3.
bool is_between(const GcodeBlock& block) {
    for (std::size_t i = 0; i < kModalGroups; ++i) {
        const auto group = static_cast<ModalGroup>(i);
        const std::int32_t code = block.codes[i];
        const bool is_spindle = group == spindle && code < 190;  // M19 takes P
        const bool is_own =
            (group == motion && code == kNurbsPoint) || (group == non_modal && code == kNurbsEnd);
        if (code != -1 && !is_spindle && !is_own && group != coolant) {
            return false;
        }
    }
    return !block.is_machine;
}

/// Whether the direction in which G5 ended counts no longer: the block moves, or changes what its
/// words would mean.
bool breaks_row(const GcodeBlock& block) {
    constexpr ModalGroup kBreaking[] = {non_modal,  motion,      plane, units, tool_length,
                                        kinematics, tool_change, stop,  saving};
    return block.code(offsets) != -1 ||
           std::any_of(std::begin(kBreaking), std::end(kBreaking),
                       [&block](ModalGroup group) { return block.code(group) != -1; });
}

bool has_any(const GcodeBlock& block, std::string_view letters) {
    return std::any_of(letters.begin(), letters.end(),
                       [&block](char letter) { return block.has(letter); });
}

bool shares_letters(const GcodeBlock& block) {
    return block.code(non_modal) != -1 || block.code(path) == 640 ||
           is_setting_letter(block, 'P') || is_setting_letter(block, 'Q') ||
           is_setting_letter(block, 'L');
}

}  // namespace

bool GcodeInterpreter::run_spline() {
    const GcodeBlock& block = *block_;
    SplineState& spline = state_.spline;
    const std::int32_t written = block.code(motion);
    if (block.code(non_modal) == kNurbsEnd) {
        end_nurbs();
        return true;
    }
    if (spline.is_open && !is_between(block)) {
        if (!std::exchange(spline.is_refused, true)) {
            fault("G5.2",
                  "only its points, F, S, and words of spindle and coolant may be between "
                  "it and G5.3; write other words before it or after G5.3");
        }
        return true;
    }
    if (spline.is_open || written == kNurbsPoint) {
        add_nurbs_point();
        return true;
    }
    if (is_single_spline(written)) {
        run_single_spline();
        return true;
    }
    spline.has_tangent = spline.has_tangent && !breaks_row(block);
    const std::int32_t other = block.code(non_modal);
    if (is_single_spline(state_.motion) && written == -1 && has_axis_word(block) &&
        !takes_axis_words(block) && other != 280 && other != 300) {
        fault(state_.motion == 50 ? "G5" : "G5.1",
              "counts for its own block: LinuxCNC would move on in the mode before it; write the "
              "motion word in this block");
        return true;
    }
    return false;
}

bool GcodeInterpreter::is_spline_block(const std::string& word) {
    std::string wrong;
    if (cutter_.is_on()) {
        wrong = "does not go with cutter compensation; write G40 before it";
    } else if (block_->is_machine) {
        wrong = "conflicts with G53; write the curve in program coordinates";
    } else if (state_.plane != 170) {
        wrong = "splines are in the plane XY; write G17 before it";
    } else if (state_.is_inverse_time) {
        wrong = "under G93 LinuxCNC has the feed of an earlier move; write G94 and F before it";
    } else if (shares_letters(*block_)) {
        wrong = "another word of the block takes its letters; write two blocks";
    } else if (state_.standing_at) {
        wrong =
            "after G40, and where the tool offset changed under tool centre point control, the "
            "curve would not begin where the tip is; write G0 or G1 before it";
    }
    for (const char letter : {'X', 'Y'}) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        if (axis == kNoIndex || machine_.axes[axis].kind != AxisKind::linear) {
            wrong = "the machine has no linear axes X and Y";
        }
    }
    for (const char letter : kAxisLetters) {
        if (letter != 'X' && letter != 'Y' && block_->has(letter)) {
            wrong = std::string("splines move X and Y only; write ") + letter + " in another block";
        }
    }
    if (!wrong.empty()) {
        fault(word, wrong);
    }
    return wrong.empty();
}

SplinePoint GcodeInterpreter::spline_point(const AxisPositions& position, double weight) const {
    const AxisPositions programmed = to_program(position);
    return {programmed[axis_of_letter(machine_, 'X')] / scale(),
            programmed[axis_of_letter(machine_, 'Y')] / scale(), weight};
}

void GcodeInterpreter::run_single_spline() {
    const GcodeBlock& block = *block_;
    SplineState& spline = state_.spline;
    state_.motion = block.code(motion);
    state_.cycle.is_in_row = false;
    const bool is_cubic = state_.motion == 50, has_i = block.has('I'), has_j = block.has('J');
    const bool goes_on = std::exchange(spline.has_tangent, false) && is_cubic;
    const std::string word = is_cubic ? "G5" : "G5.1";
    if (!is_spline_block(word)) {
        return;
    }
    if (!block.has('X') && !block.has('Y')) {
        fault(word, "expected X and Y, the end of the curve");
        return;
    }
    if (has_i != has_j || (!has_i && !goes_on)) {
        fault(word, is_cubic
                        ? "expected I and J, from the start to its control point; only directly "
                          "after another G5 both may be left out"
                        : "expected I and J, from the start to the control point");
        return;
    }
    if (is_cubic && (!block.has('P') || !block.has('Q'))) {
        fault(word, "expected P and Q, from the end to its control point");
        return;
    }
    Move last = new_move(MoveKind::arc);
    if (is_unknown_arc() || !set_target(last.target) || !set_feed(last)) {
        return;
    }
    const SplinePoint start = spline_point(state_.position, 1), end = spline_point(last.target, 1);
    const double i = has_i ? block.value('I') : spline.next_i;
    const double j = has_j ? block.value('J') : spline.next_j;
    std::vector<SplinePoint> points = {start, {start.first + i, start.second + j}, end};
    if (is_cubic) {
        const double p = block.value('P'), q = block.value('Q');
        points.insert(points.begin() + 2, {end.first + p, end.second + q});
        spline.has_tangent = true;
        spline.next_i = -p;
        spline.next_j = -q;
    }
    follow_spline(word, points, static_cast<std::uint32_t>(points.size()), last);
}

void GcodeInterpreter::add_nurbs_point() {
    SplineState& spline = state_.spline;
    const bool is_first = !spline.is_open;
    if (is_first) {
        spline = {};
        spline.is_open = true;
        state_.motion = kNurbsPoint;
        state_.cycle.is_in_row = false;
    }
    const bool has_letter = has_axis_word(*block_) || has_any(*block_, "IJKLPQR");
    if (!spline.is_refused && (has_letter || block_->code(motion) != -1)) {
        spline.is_refused = !read_nurbs_words(is_first);
    }
}

bool GcodeInterpreter::read_nurbs_words(bool is_first) {
    const GcodeBlock& block = *block_;
    SplineState& spline = state_.spline;
    const double weight = block.value('P', is_first && !block.has('X') ? 1 : 0);
    const double order = block.value('L', spline.order == 0 ? kSplineOrderMin : spline.order);
    std::string wrong;
    if (!is_spline_block("G5.2")) {
        return false;
    }
    if (has_any(block, "IJKQR")) {
        wrong = "takes X, Y, P and L only";
    } else if (state_.is_incremental) {
        wrong =
            "under G91 LinuxCNC counts all points from the start of the curve; write G90 before "
            "it";
    } else if (block.has('X') != block.has('Y') || (!is_first && !block.has('X'))) {
        wrong = "expected X, Y and P of a control point";
    } else if (!(weight > 0)) {
        wrong = "expected P above 0, the weight of the control point";
    } else if (order != std::floor(order) || order < kSplineOrderMin || order > kSplineOrderMax) {
        wrong = print("L: found %.6g, expected an order from 3 to %.0f", order, kSplineOrderMax);
    } else if (block.has('L') && spline.order != 0 && order != spline.order) {
        wrong =
            print("L: found %.6g after %.0f; LinuxCNC would take one of them", order, spline.order);
    }
    if (!wrong.empty()) {
        fault("G5.2", wrong);
        return false;
    }
    if (is_first && (is_unknown_arc() || !(feed_per_minute(true) > 0))) {
        return false;
    }
    if (is_first) {
        spline.points.push_back(spline_point(state_.position, block.has('X') ? 1 : weight));
    }
    spline.order = block.has('L') ? static_cast<std::uint32_t>(order) : spline.order;
    if (block.has('X')) {
        spline.end = state_.position;
        if (!set_target(spline.end)) {
            return false;
        }
        spline.points.push_back(spline_point(spline.end, weight));
    }
    return true;
}

void GcodeInterpreter::end_nurbs() {
    const SplineState spline = std::exchange(state_.spline, {});
    const std::uint32_t order = std::max(spline.order, kSplineOrderMin);
    std::string wrong;
    if (!spline.is_open) {
        wrong = "expected G5.2 before it, and only its points between the two";
    } else if (!is_between(*block_) || block_->code(motion) != -1 || has_axis_word(*block_) ||
               has_any(*block_, "IJKLPQR")) {
        wrong = "LinuxCNC runs it before other words of its block; write it in a block of its own";
    } else if (spline.points.size() < order) {
        wrong = print("found %.0f control points with the start, expected %.0f or more (L of G5.2)",
                      static_cast<double>(spline.points.size()), order);
    }
    if (!spline.is_refused && wrong.empty()) {
        Move last = new_move(MoveKind::arc);
        last.target = spline.end;
        if (set_feed(last)) {
            follow_spline("G5.3", spline.points, order, last);
        }
    } else if (!spline.is_refused) {
        fault("G5.3", wrong);
    }
    state_.motion = 800;  // axis words want a motion word
}

void GcodeInterpreter::follow_spline(const std::string& word,
                                     const std::vector<SplinePoint>& points, std::uint32_t order,
                                     const Move& last) {
    const SplineShape shape = solve_spline(points, order);
    if (!shape.fault.empty()) {
        fault(word, shape.fault);
        return;
    }
    const std::uint32_t x = axis_of_letter(machine_, 'X'), y = axis_of_letter(machine_, 'Y');
    const auto to_machine = [&](double first, double second, AxisPositions& out) {
        AxisPositions programmed{};
        programmed[x] = first * scale();
        programmed[y] = second * scale();
        programmed = from_program(programmed);
        out[x] = programmed[x];
        out[y] = programmed[y];
    };
    for (const SplinePiece& piece : shape.pieces) {
        Move next = last;
        if (&piece != &shape.pieces.back()) {
            to_machine(piece.end_first, piece.end_second, next.target);
        }
        AxisPositions center{};
        to_machine(piece.center_first, piece.center_second, center);
        next.arc = {
            .first = x, .second = y, .center_first_mm = center[x], .center_second_mm = center[y]};
        append_bend(piece, next);
        if (state_.has_ended) {
            return;
        }
    }
}

void GcodeInterpreter::append_bend(const SplinePiece& piece, Move next) {
    Arc& arc = next.arc;
    const double from_first = state_.position[arc.first] - arc.center_first_mm;
    const double from_second = state_.position[arc.second] - arc.center_second_mm;
    arc.radius_start_mm = std::hypot(from_first, from_second);
    if (!piece.is_arc || arc.radius_start_mm < kRadiusMmMin || arc.radius_start_mm > kRadiusMmMax) {
        append_flat_bend(piece.is_arc && arc.radius_start_mm > kRadiusMmMax, next);
        return;
    }
    const double way_first = next.target[arc.first] - state_.position[arc.first];
    const double way_second = next.target[arc.second] - state_.position[arc.second];
    const double cross = from_first * way_second - from_second * way_first;
    const double dot =
        from_first * (from_first + way_first) + from_second * (from_second + way_second);
    const double angle = std::atan2(cross, dot);
    const bool is_against = piece.is_clockwise ? angle >= 0 : angle <= 0;
    arc.radius_end_mm = std::hypot(from_first + way_first, from_second + way_second);
    arc.start_rad = std::atan2(from_second, from_first);
    arc.sweep_rad = angle + (is_against ? (piece.is_clockwise ? -2 : 2) * kPi : 0);
    append(next);
}

/// A circle of so large a radius is a parabola on every chord inside a travel.
void GcodeInterpreter::append_flat_bend(bool is_arc, Move next) {
    const Arc arc = std::exchange(next.arc, {});
    const AxisPositions from = state_.position, to = next.target;
    const double way_first = to[arc.first] - from[arc.first];
    const double way_second = to[arc.second] - from[arc.second];
    const double out_first = from[arc.first] + way_first / 2 - arc.center_first_mm;
    const double out_second = from[arc.second] + way_second / 2 - arc.center_second_mm;
    const double rise_mm =
        is_arc ? (way_first * way_first + way_second * way_second) / (8 * arc.radius_start_mm) : 0;
    const int parts = static_cast<int>(std::max(1.0, std::ceil(std::sqrt(rise_mm / kFlatMm))));
    next.kind = MoveKind::line;
    next.is_exact = state_.is_exact;
    for (int part = 1; part <= parts && !state_.has_ended; ++part) {
        const double share = static_cast<double>(part) / parts;
        const double bulge =
            is_arc ? 4 * rise_mm * share * (1 - share) / std::hypot(out_first, out_second) : 0;
        next.target = to;
        if (part < parts) {
            next.target[arc.first] = from[arc.first] + share * way_first + bulge * out_first;
            next.target[arc.second] = from[arc.second] + share * way_second + bulge * out_second;
        }
        append(next);
    }
}

}  // namespace axg
