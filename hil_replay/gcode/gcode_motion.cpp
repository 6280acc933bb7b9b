// SPDX-License-Identifier: Apache-2.0
// The words that move axes: G0 to G3, G28, G53.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_arc.hpp"
#include "hil_replay/gcode/gcode_interpreter.hpp"
#include "hil_replay/gcode/gcode_travel.hpp"

namespace axg {
namespace {

using enum ModalGroup;

constexpr double kRadPerDegree = kPi / 180.0;

std::string print(const char* format, double a) {
    char text[160];
    std::snprintf(text, sizeof text, format, a);
    return text;
}

bool has_arc_word(const GcodeBlock& block, std::int32_t motion_code) {
    return block.has('J') || (block.has('R') && !is_setting_letter(block, 'R')) ||
           (motion_code != 331 && block.has('I')) || (!is_thread(motion_code) && block.has('K'));
}

}  // namespace

void GcodeInterpreter::move_home(const char* word) {
    if (block_->code(motion) != -1) {
        fault(word, "conflicts with a motion word in the same block; write two blocks");
    } else if (state_.control != kNoIndex) {
        fault(word, "its position means axes; switch tool centre point control off before it");
    } else {
        go_home();
    }
}

bool GcodeInterpreter::are_letters_taken(bool is_arc_mode) {
    const bool takes_words = block_->code(path) != -1 || block_->code(non_modal) != -1;
    for (const char letter : {'L', 'P', 'Q'}) {
        const bool is_taken =
            takes_words || (letter == 'P' && is_arc_mode) || is_setting_letter(*block_, letter);
        if (block_->has(letter) && !is_taken) {
            fault(std::string(1, letter), letter == 'P' ? "only arcs and canned cycles use it here"
                                                        : "only canned cycles use it here");
            return false;
        }
    }
    return true;
}

void GcodeInterpreter::move() {
    const GcodeBlock& block = *block_;
    const std::int32_t written = block.code(motion);
    if (run_spline()) {
        return;
    }
    if (block.code(non_modal) == 280 || block.code(non_modal) == 300) {
        move_home(block.code(non_modal) == 280 ? "G28" : "G30");
        return;
    }
    const std::int32_t last_motion = state_.motion;
    if (written != -1) {
        state_.motion = written;
    }
    const bool is_cycle = is_canned_cycle(state_.motion);
    state_.cycle.is_in_row = is_cycle && state_.cycle.is_in_row;
    if (takes_axis_words(block)) {
        return;
    }
    const bool has_axis = has_axis_word(block);
    const bool is_threading = is_thread(state_.motion);
    const bool has_arc = has_arc_word(block, state_.motion);
    if (cutter_.is_on() && state_.motion > 30 && state_.motion != 800 &&
        (written != -1 || has_axis)) {
        fault("G41", "cutter compensation goes with G0 to G3 only; write G40 before");
        return;
    }
    const bool is_arc_mode = state_.motion == 20 || state_.motion == 30;
    if (is_cycle && (written != -1 || has_axis || has_arc)) {
        run_cycle(last_motion, has_axis);
        return;
    }
    if (!are_letters_taken(is_arc_mode)) {
        return;
    }
    if (has_arc && !is_arc_mode) {
        fault("I J K R", "only G2 and G3 use these, and the motion mode is another");
        return;
    }
    if (block.is_machine && (is_arc_mode || state_.is_incremental || !has_axis)) {
        fault("G53", "expected G0 or G1 with axis words and G90");
        return;
    }
    if (!has_axis && !has_arc) {
        if (written != -1 && (is_threading || is_probe(written))) {
            fault(is_threading ? "G33" : "G38", "expected axis words");
        }
        return;
    }
    if (block.code(non_modal) == 40 && is_arc_mode) {
        fault("G4", "conflicts with an arc in the same block; write two blocks");
        return;
    }
    if (state_.motion == 800) {
        fault("G80", "axis words without a motion mode; write G0, G1, G2 or G3");
        return;
    }
    if (is_threading || is_probe(state_.motion)) {
        is_threading ? run_thread() : probe();
        return;
    }
    if (is_arc_mode && is_unknown_arc()) {
        return;
    }
    move_to_target(is_arc_mode);
}

void GcodeInterpreter::move_to_target(bool is_arc_mode) {
    Move next = new_move(is_arc_mode ? MoveKind::arc : MoveKind::line);
    if (!set_target(next.target) || !set_feed(next) || (is_arc_mode && !set_arc(next))) {
        return;
    }
    if (cutter_.is_on() && cutter_.settings().radius_mm > 0) {
        follow_contour(next);
        return;
    }
    append(next);
}

bool GcodeInterpreter::set_target(AxisPositions& target) {
    const std::size_t faults_before = result_.faults.size();
    for (const char letter : kAxisLetters) {
        if (!block_->has(letter)) {
            continue;
        }
        const std::uint32_t index = named_axis(letter);
        if (index == kNoIndex) {
            continue;
        }
        const double value = word_value(letter, machine_.axes[index]);
        if (state_.is_incremental && is_unknown_after_probe(letter, index)) {
            return false;
        }
        state_.is_probed[index] = false;
        if (state_.is_incremental) {
            target[index] = state_.position[index] + value;
        } else if (block_->is_machine) {
            target[index] = value;
        } else {
            target[index] = value + offset_of(index);
        }
        if (!state_.is_incremental && machine_.axes[index].unlimited) {
            target[index] = by_rotary_rule(letter, index, target[index], block_->value(letter));
            keep_word(index, target[index]);
        }
    }
    set_rotated_target(target);
    if (state_.motion != 20 && state_.motion != 30) {  // an arc judges its ends together
        settle(target, programmed_at());
    }
    return result_.faults.size() == faults_before;
}

double GcodeInterpreter::by_rotary_rule(char letter, std::uint32_t axis, double target,
                                        double word_deg) {
    const RotaryRule rule = options_.program.rotary[axis];
    const double from = state_.position[axis];
    const double way = std::remainder(target - from, 2 * kPi);
    const bool is_half = kPi - std::abs(way) < kSamePlaceRad;
    const bool is_short = !is_half && std::abs(from + way - target) < kSamePlaceRad;
    const bool is_there = is_short && std::abs(way) < kSamePlaceRad;
    const std::string word(1, letter);
    if (rule == RotaryRule::unknown) {
        const bool is_upwards = way >= 0 && !std::signbit(word_deg) && word_deg < 360;
        const bool is_reported =
            std::find(unruled_.begin(), unruled_.end(), axis) != unruled_.end();
        if (is_there || (is_short && is_upwards) || is_reported) {
            return target;  // every rule goes there
        }
        unruled_.push_back(axis);
        fault(word, "the machine file has no program.rotary." + word +
                        ", which decides how far this endless axis turns; state it there, or pass "
                        "--rotary");
        return target;
    }
    if (rule == RotaryRule::wrapped) {
        assume(word + " wrapped");
        return wrapped_target(letter, axis, target, word_deg);
    }
    if (is_short) {
        return target;
    }
    assume(word + (rule == RotaryRule::programmed ? " programmed" : " short"));
    if (rule == RotaryRule::programmed) {
        return target;
    }
    if (is_half) {
        fault(word,
              "half a turn: the shortest way is up as well as down; write a position between, or "
              "pass --rotary programmed");
    }
    return from + way;
}

void GcodeInterpreter::keep_word(std::uint32_t axis, double target) {
    const bool is_sum = block_->is_machine || block_->code(non_modal) != -1;
    if (!is_sum || offset_of(axis) == 0) {
        state_.word_position[axis] = target;
        state_.word_offset[axis] = offset_of(axis);
    }
}

/// Source: LinuxCNC 2.9, interp_find.cc, unwrap_rotary, in degrees of the program's coordinates.
double GcodeInterpreter::wrapped_target(char letter, std::uint32_t axis, double target,
                                        double word_deg) {
    constexpr double kTurnDeg = 360, kTinyDeg = 1e-8;
    const double offset = offset_of(axis);
    const double position = (state_.position[axis] - offset) / kRadPerDegree;
    const double turns = std::round(position / kTurnDeg) * kTurnDeg;
    const bool is_at_turn = std::abs(position - turns) < kTinyDeg;
    const double from = is_at_turn ? turns : position;
    const double angle = std::abs((target - offset) / kRadPerDegree);
    const std::string word(1, letter);
    if (!(std::abs(word_deg) < kTurnDeg)) {
        fault(word, print("found %.6g, expected an angle between -360 and 360 on a wrapped axis",
                          word_deg));
        return target;
    }
    const bool is_there = std::abs(std::remainder(angle - from, kTurnDeg)) < kTinyDeg;
    const bool is_sum = state_.position[axis] != state_.word_position[axis] ||
                        offset != state_.word_offset[axis] || (block_->is_machine && offset != 0);
    if (is_sum && (is_there || (is_at_turn && angle >= kTurnDeg))) {
        fault(word,
              "the axis is where it is by sums of other words: rounding would decide between a "
              "turn and none; write another angle before");
    }
    if (is_there) {
        return state_.position[axis];
    }
    double result = angle + std::floor(from / kTurnDeg) * kTurnDeg;
    if (!std::signbit(word_deg) && result < from) {
        result += kTurnDeg;
    } else if (std::signbit(word_deg) && result > from) {
        result -= kTurnDeg;
    }
    return result * kRadPerDegree + offset;
}

void GcodeInterpreter::settle(AxisPositions& target, const AxisPositions& from) const {
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        const bool is_rotary = machine_.axes[i].kind == AxisKind::rotary;
        if (std::abs(target[i] - from[i]) < (is_rotary ? kSamePlaceRad : kSamePlaceMm)) {
            target[i] = from[i];
        }
    }
}

std::uint32_t GcodeInterpreter::named_axis(char letter) {
    const std::uint32_t axis = axis_of_letter(machine_, letter);
    if (axis == kNoIndex) {
        fault(std::string(1, letter), "the machine has no axis of this name");
    }
    return axis;
}

double GcodeInterpreter::offset_of(std::uint32_t axis) const {
    return state_.work_offsets[state_.work_offset][axis] + state_.local_offset[axis] +
           state_.tool_offset[axis];
}

double GcodeInterpreter::word_value(char letter, const Axis& axis) const {
    return block_->value(letter) * (axis.kind == AxisKind::rotary ? kRadPerDegree : scale());
}

bool GcodeInterpreter::set_feed(Move& next) {
    if (state_.motion == 0) {
        return true;
    }
    if (state_.is_inverse_time) {
        next.feed_kind = FeedKind::inverse;
        next.feed = block_->value('F');
        if (!(next.feed > 0)) {
            fault("F", "G93 is on: every block with a feed move wants its own F above 0");
            return false;
        }
        return true;
    }
    bool moves_linear = state_.motion != 10;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        moves_linear = moves_linear || (machine_.axes[i].kind == AxisKind::linear &&
                                        next.target[i] != programmed_at()[i]);
    }
    next.feed_kind = FeedKind::per_minute;
    next.feed = feed_per_minute(moves_linear);
    return next.feed > 0;
}

double GcodeInterpreter::feed_per_minute(bool moves_linear) {
    if (!(state_.feed > 0)) {
        if (!state_.is_feed_unknown) {
            fault("F", "no feed is set; write F above 0 in this block or before it");
        }
        return 0;
    }
    if (moves_linear) {
        use_start_unit('F');
    }
    return state_.feed * (moves_linear ? state_.feed_scale : 1.0) *
           (state_.is_per_revolution ? spindle_speed("G95") : 1.0);
}

double GcodeInterpreter::spindle_speed(const char* word) {
    if (state_.has_surface_speed) {
        fault(word, "under G96 the speed of the spindle depends on the radius; write G97 and S");
        return 0;
    }
    if (!(state_.spindle_rev_min > 0)) {
        fault(word, "the spindle is off; write S above 0 before a move at feed");
        return 0;
    }
    return state_.spindle_rev_min;
}

namespace {

struct ArcPlane {
    char first, second, center_first, center_second, center_other;
};

/// Why this block states no centre or radius in the plane; empty: it does.
std::string shape_fault(const GcodeBlock& block, const ArcPlane& plane, bool has_absolute_centers) {
    const bool has_first = block.has(plane.center_first),
               has_second = block.has(plane.center_second);
    if (block.has(plane.center_other)) {
        return std::string(1, plane.center_other) + " is not in the plane of the arc";
    }
    if ((has_first || has_second) == block.has('R')) {
        return block.has('R') ? "found both R and a centre, expected one of them"
                              : "expected R, or the centre as I J K of the plane";
    }
    return has_absolute_centers && has_first != has_second
               ? "G90.1 is on: expected both words of the centre"
               : "";
}

}  // namespace

bool GcodeInterpreter::set_arc(Move& next) {
    const ArcPlane plane_letters = state_.plane == 170   ? ArcPlane{'X', 'Y', 'I', 'J', 'K'}
                                   : state_.plane == 180 ? ArcPlane{'Z', 'X', 'K', 'I', 'J'}
                                                         : ArcPlane{'Y', 'Z', 'J', 'K', 'I'};
    const std::string word = state_.motion == 20 ? "G2" : "G3";
    next.arc.first = axis_of_letter(machine_, plane_letters.first);
    next.arc.second = axis_of_letter(machine_, plane_letters.second);
    if (next.arc.first == kNoIndex || next.arc.second == kNoIndex ||
        machine_.axes[next.arc.first].kind != AxisKind::linear ||
        machine_.axes[next.arc.second].kind != AxisKind::linear) {
        fault(word, std::string("the machine has no linear axes ") + plane_letters.first + " and " +
                        plane_letters.second + " for this plane");
        return false;
    }
    const std::string no_shape = shape_fault(*block_, plane_letters, state_.has_absolute_centers);
    if (!no_shape.empty()) {
        fault(word, no_shape);
        return false;
    }
    if (state_.plane != 170 && is_rotated()) {
        refuse_rotated(word);
        return false;
    }
    if (state_.standing_at && !cutter_.is_beside()) {
        fault(word,
              "after G40, and where the tool offset changed under tool centre point control, the "
              "arc would not begin where the tip is; write G0 or G1 before it");
        return false;
    }
    ArcWords words;
    words.start_first = state_.position[next.arc.first];
    words.start_second = state_.position[next.arc.second];
    words.end_first = next.target[next.arc.first];
    words.end_second = next.target[next.arc.second];
    words.has_radius = block_->has('R');
    words.radius = block_->value('R') * scale();
    words.center_first = arc_center(plane_letters.center_first, plane_letters.first);
    words.center_second = arc_center(plane_letters.center_second, plane_letters.second);
    if (is_rotated()) {
        AxisPositions center =
            state_.has_absolute_centers ? AxisPositions{} : programmed_position();
        center[next.arc.first] += block_->value(plane_letters.center_first) * scale();
        center[next.arc.second] += block_->value(plane_letters.center_second) * scale();
        center = from_program(center);
        words.center_first = center[next.arc.first];
        words.center_second = center[next.arc.second];
    }
    words.is_clockwise = state_.motion == 20;
    words.tolerance_mm = state_.is_inch ? options_.program.arc_tolerance_inch * scale()
                                        : options_.program.arc_tolerance_mm;
    const double turns = block_->value('P', 1);
    if (turns != std::floor(turns) || turns < 1 || turns > 10000) {
        fault(word, print("P: found %.6g, expected an integer number of turns from 1", turns));
        return false;
    }
    words.turns = static_cast<int>(turns);
    const ArcShape shape = solve_arc(words);
    if (!shape.fault.empty()) {
        fault(word, shape.fault);
        return false;
    }
    next.arc.center_first_mm = shape.center_first;
    next.arc.center_second_mm = shape.center_second;
    next.arc.radius_start_mm = shape.radius_start;
    next.arc.radius_end_mm = shape.radius_end;
    next.arc.start_rad = shape.start_rad;
    next.arc.sweep_rad = shape.sweep_rad;
    return true;
}

double GcodeInterpreter::arc_center(char center_letter, char axis_letter) const {
    const std::uint32_t axis = axis_of_letter(machine_, axis_letter);
    const double value = block_->value(center_letter) * scale();
    if (state_.has_absolute_centers) {
        return value + offset_of(axis);
    }
    return value + state_.position[axis];
}

void GcodeInterpreter::go_home() {
    if (is_rotated() && block_->has('X') != block_->has('Y')) {
        refuse_rotated("G28 of one of X and Y");  // LinuxCNC keeps the other as programmed
        return;
    }
    Move way = new_move(MoveKind::line);
    way.is_exact = true;
    if (!set_target(way.target)) {
        return;
    }
    bool has_words = false;
    for (const char letter : kAxisLetters) {
        has_words = has_words || block_->has(letter);
    }
    if (has_words) {
        append(way);
    }
    Move home = new_move(MoveKind::line);
    home.is_exact = true;
    const bool is_first = block_->code(non_modal) == 280;
    const StoredPosition& stored = is_first ? options_.program.g28 : options_.program.g30;
    const std::string word = is_first ? "G28" : "G30", key = is_first ? "g28" : "g30";
    for (const char letter : kAxisLetters) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        if (axis == kNoIndex || (has_words && !block_->has(letter))) {
            continue;
        }
        if (!stored[axis]) {
            fault(word, std::string("its stored position is unknown; state program.") + key + "." +
                            letter + " in the machine file, or write G53 G0 with the position");
            return;
        }
        const bool is_rotary = machine_.axes[axis].kind == AxisKind::rotary;
        const double shown = *stored[axis] / (is_rotary ? kRadPerDegree : 1.0);
        assume(word + " " + letter + print("%.6g", shown));
        home.target[axis] = *stored[axis];
        state_.is_probed[axis] = false;
        if (options_.program.rotary[axis] == RotaryRule::wrapped && machine_.axes[axis].unlimited) {
            home.target[axis] = wrapped_target(letter, axis, *stored[axis], shown);
            keep_word(axis, home.target[axis]);
        }
    }
    append(home);
}

AxisPositions GcodeInterpreter::standing_at() const {
    return state_.standing_at.value_or(state_.position);
}

AxisPositions GcodeInterpreter::programmed_at() const {
    return cutter_.is_beside() ? state_.position : standing_at();
}

Move GcodeInterpreter::new_move(MoveKind kind) const {
    Move next;
    next.kind = kind;
    next.is_exact = state_.is_exact || kind != MoveKind::line;
    next.blend_mm = state_.blend_mm;
    next.line = block_->line;
    next.tool = state_.spindle_tool;
    next.control = state_.control;
    const bool goes_on = kind == MoveKind::line || kind == MoveKind::arc;
    next.target = goes_on ? state_.position : standing_at();
    return next;
}

void GcodeInterpreter::append(Move next) {
    settle(next.target, standing_at());
    travel_.check(machine_, result_.program, standing_at(), next, result_.faults);
    const bool is_still = next.kind == MoveKind::line && next.target == standing_at();
    state_.position = next.target;
    state_.standing_at.reset();
    if (!is_still) {
        push(next);
    }
}

void GcodeInterpreter::push(const Move& next) {
    if (result_.program.moves.size() >= options_.moves_max) {
        fault("program", "longer than " + std::to_string(options_.moves_max) +
                             " moves; split it, or raise the limit with --max-moves N");
        state_.has_ended = true;
        return;
    }
    result_.program.moves.push_back(next);
}

}  // namespace axg
