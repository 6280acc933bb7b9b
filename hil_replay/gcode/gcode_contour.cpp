// SPDX-License-Identifier: Apache-2.0
// G40 to G42.1: the words of cutter compensation, and the moves that it makes (gcode_cutter.hpp).
// Source: LinuxCNC, "Cutter Compensation"; its interpreter (2.9) refuses the words refused here.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {
namespace {

using enum ModalGroup;

constexpr double kRoundingMm = 1e-6;  // a shorter way may be a sum's rounding
constexpr const char* kWriteG40 = "does not go with cutter compensation; write G40 before it";

std::string print(const char* format, double a) {
    char text[160];
    std::snprintf(text, sizeof text, format, a);
    return text;
}

/// Words that LinuxCNC runs before G40 to G42.1 of the same block.
std::string early_fault(const GcodeBlock& block, const GcodeState& state) {
    const std::int32_t new_plane = block.code(plane), new_unit = block.code(units);
    if (block.code(tool_change) != -1) {
        return "M6";
    }
    if (block.code(overrides) != -1) {
        return "M48 to M53";
    }
    if (block.code(outputs) != -1) {
        return "M62 to M68";
    }
    if (block.code(saving) != -1) {
        return "M70 to M73";
    }
    if (new_plane != -1 && new_plane != state.plane) {
        return "G17 to G19";
    }
    return new_unit != -1 && (new_unit == 200) != state.is_inch ? "G20, G21" : "";
}

/// Words that it runs after them.
std::string late_fault(const GcodeBlock& block) {
    const std::int32_t special = block.code(non_modal);
    if (block.code(feed_mode) == 930) {
        return "G93";
    }
    if (block.code(tool_length) != -1 || block.code(kinematics) != -1) {
        return "a tool offset";
    }
    if (block.code(offsets) != -1) {
        return "a work offset";
    }
    if (block.code(path) != -1) {
        return "G61, G64";
    }
    if (block.code(retract) != -1) {
        return "G98, G99";
    }
    if (block.is_machine) {
        return "G53";
    }
    return special != -1 && special != 40 ? "G10, G28, G30, G52, G92" : "";
}

}  // namespace

bool GcodeInterpreter::is_contour_block() {
    const std::int32_t code = block_->code(cutter);
    const bool begins = code > 400, ends = code == 400;
    std::string word = cutter_.is_on() ? early_fault(*block_, state_) : "";
    if (word.empty() && (begins || (cutter_.is_on() && !ends))) {
        word = late_fault(*block_);
    }
    if (!word.empty()) {
        fault(word, kWriteG40);
    }
    return word.empty();
}

void GcodeInterpreter::set_cutter() {
    const std::int32_t code = block_->code(cutter);
    if (code == 400) {
        flush_contour();
        cutter_.stop();
    } else if (code != -1) {
        const bool is_left = code < 420, is_stated = code % 10 != 0;
        begin_contour(is_stated ? (is_left ? "G41.1" : "G42.1") : is_left ? "G41" : "G42");
    }
}

void GcodeInterpreter::begin_contour(const std::string& word) {
    if (cutter_.is_on()) {
        fault(word, "cutter compensation is on; write G40 before it");
        return;
    }
    const bool is_xy = state_.plane == 170;
    CutterPath::Settings settings;
    settings.first = axis_of_letter(machine_, is_xy ? 'X' : 'Z');
    settings.second = axis_of_letter(machine_, is_xy ? 'Y' : 'X');
    settings.third = axis_of_letter(machine_, is_xy ? 'Z' : 'Y');
    const auto is_linear = [this](std::uint32_t axis) {
        return axis != kNoIndex && machine_.axes[axis].kind == AxisKind::linear;
    };
    std::string wrong;
    if (state_.plane == 190 || !is_linear(settings.first) || !is_linear(settings.second)) {
        wrong = "expected linear axes X and Y with G17, or Z and X with G18";
    } else if (state_.control != kNoIndex) {
        wrong = "not supported under tool centre point control";
    } else if (state_.is_inverse_time) {
        wrong = "conflicts with G93; write G94 before it";
    } else if (!is_xy && is_rotated()) {
        wrong = "not supported with G18 in a rotated work offset";
    } else if (!is_xy && block_->code(cutter) % 10 == 0) {
        wrong =
            "depends with G18 on the orientation in the control's tool table; write G41.1 or "
            "G42.1 and D";
    }
    if (!wrong.empty()) {
        fault(word, wrong);
        return;
    }
    if (is_unknown_arc()) {
        return;
    }
    const std::optional<double> diameter_mm = cutter_diameter(word);
    if (!diameter_mm) {
        return;
    }
    settings.is_left = (word < "G42") == (*diameter_mm >= 0);  // a negative one changes the side
    settings.radius_mm = std::abs(*diameter_mm) / 2;
    settings.unit_mm = scale();
    cutter_.start(settings);
}

std::optional<double> GcodeInterpreter::cutter_diameter(const std::string& word) {
    if (block_->code(cutter) % 10 != 0) {
        use_start_unit('D');
        if (!block_->has('D')) {
            fault(word, "expected D, the diameter");
            return std::nullopt;
        }
        return block_->value('D') * scale();
    }
    std::optional<std::uint16_t> number = state_.spindle_tool;
    if (block_->has('D')) {
        number = tool_number('D');
        number = number == 0 ? state_.spindle_tool : number;
    }
    if (!number) {
        return std::nullopt;
    }
    const Tool* const tool = find_tool(*number);
    if (tool == nullptr || !tool->diameter_mm) {
        fault(word, tool == nullptr
                        ? std::string("no tool in the spindle; write D, or T and M6 before")
                        : std::string("the machine file states no tools.")
                              .append(std::to_string(*number))
                              .append(".diameter_mm, that of the control's tool table"));
        return std::nullopt;
    }
    assume(std::string("tool ")
               .append(std::to_string(*number))
               .append(print(" diameter %.9g mm", *tool->diameter_mm)));
    return tool->diameter_mm;
}

void GcodeInterpreter::follow_contour(Move next) {
    const CutterPath::Settings& cut = cutter_.settings();
    const bool is_arc = next.kind == MoveKind::arc;
    bool has_moved = false;
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
        const char letter = machine_.axes[i == 0 ? cut.first : cut.second].name.front();
        const double word = block_->value(letter), before = contour_words_[i];
        const bool is_step = state_.is_incremental;
        double& now = contour_words_[i];
        if (!cutter_.is_beside()) {
            now = block_->has(letter) && !is_step ? word : NAN;
        } else if (block_->has(letter) && !(is_step && word == 0)) {
            now = is_step ? before + word : word;
            has_moved = has_moved || !(now == before);
        }
    }
    const double way_mm = std::hypot(next.target[cut.first] - state_.position[cut.first],
                                     next.target[cut.second] - state_.position[cut.second]);
    if (cutter_.is_beside() && !is_arc && has_moved && way_mm < kRoundingMm) {
        fault("G41",
              "the contour ends where it was by sums of other words: rounding would decide "
              "its direction; leave the words out");
        return;
    }
    if (!is_arc && !has_moved && cutter_.is_beside()) {
        next.target[cut.first] = state_.position[cut.first];
        next.target[cut.second] = state_.position[cut.second];
    }
    state_.standing_at = standing_at();
    const int turns =
        is_arc ? static_cast<int>(block_->value('P', 1)) * (state_.motion == 20 ? -1 : 1) : 0;
    std::vector<Move> moves;
    const std::string wrong = cutter_.add(next, state_.position, turns, moves);
    state_.position = next.target;
    release(moves);
    if (!wrong.empty()) {
        fault("G41", "cutter compensation: " + wrong);
    }
}

void GcodeInterpreter::flush_contour() {
    std::vector<Move> moves;
    const std::string wrong = cutter_.flush(moves);
    release(moves);
    if (!wrong.empty()) {
        fault("G41", "cutter compensation: " + wrong);
    }
}

void GcodeInterpreter::release(std::vector<Move>& moves) {
    for (Move& move : moves) {
        const AxisPositions from = standing_at();
        if (move.kind == MoveKind::dwell) {
            move.target = from;
            push(move);
            continue;
        }
        const std::string wrong =
            move.kind == MoveKind::arc ? CutterPath::finish_arc(from, move) : std::string();
        if (!wrong.empty()) {
            result_.faults.push_back({move.line, "G41", "cutter compensation: " + wrong});
        }
        settle(move.target, from);
        travel_.check(machine_, result_.program, from, move, result_.faults);
        const bool is_still = move.kind == MoveKind::line && move.target == from;
        state_.standing_at = move.target;
        if (!is_still) {
            push(move);
        }
    }
}

}  // namespace axg
