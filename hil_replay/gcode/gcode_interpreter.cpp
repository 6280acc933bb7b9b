// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_interpreter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "core/base/sincos.hpp"

namespace axg {
namespace {

using enum ModalGroup;

constexpr double kMmPerInch = 25.4;

std::string print(const char* format, double a) {
    char text[160];
    std::snprintf(text, sizeof text, format, a);
    return text;
}

}  // namespace

GcodeInterpreter::GcodeInterpreter(const Machine& machine, const GcodeOptions& options,
                                   GcodeResult& result)
    : machine_(machine), options_(options), result_(result) {
    state_.position = options.start;
    state_.spindle_tool = machine.first_tool;
    state_.work_offsets = options.work_offsets;
    state_.rotations_rad = options.rotations_rad;
    state_.word_position = options.start;
    for (std::uint32_t axis = 0; axis < machine.axes.size(); ++axis) {
        state_.word_offset[axis] = offset_of(axis);
    }
    state_.is_inch = options.program.starts_in_inch.value_or(false);
    result_.program.start = options.start;
    result_.program.start_tool = machine.first_tool;
}

std::optional<double> GcodeInterpreter::parameter(std::uint32_t index) const {
    constexpr std::uint32_t kWorkOffset = 5220, kTool = 5400, kPosition = 5420;
    if (index == kWorkOffset) {
        return static_cast<double>(state_.work_offset + 1);
    }
    if (index == kTool) {
        return state_.spindle_tool;
    }
    if (index < kPosition || index >= kPosition + std::size(kAxisLetters)) {
        return std::nullopt;
    }
    const char letter = kAxisLetters[index - kPosition];
    const std::uint32_t axis = axis_of_letter(machine_, letter);
    if (axis == kNoIndex) {
        return 0.0;
    }
    if (state_.is_probed[axis] || cutter_.is_beside()) {
        return std::nullopt;  // only the machine knows
    }
    const bool is_rotary = machine_.axes[axis].kind == AxisKind::rotary;
    return programmed_position()[axis] / (is_rotary ? kPi / 180.0 : scale());
}

void GcodeInterpreter::run(const GcodeBlock& block) {
    block_ = &block;
    if (!is_contour_block()) {
        return;
    }
    set_feed_and_tool();
    change_tool();
    dwell();
    wait_for_input();
    save_modes();
    const double rotation_before_rad = rotation_rad();
    set_modes();
    use_lengths();
    write_offsets();
    check_rotation(rotation_before_rad);
    forget_words();
    move();
    stop();
}

void GcodeInterpreter::set_feed_and_tool() {
    const GcodeBlock& block = *block_;
    if (block.code(feed_mode) != -1) {
        state_.is_inverse_time = block.code(feed_mode) == 930;
        state_.is_per_revolution = block.code(feed_mode) == 950;
        if (!state_.is_inverse_time) {
            state_.feed = 0;  // as in LinuxCNC, even if the mode was already on
        }
    }
    if (block.has('F')) {
        const double feed = block.value('F');
        if (feed < 0) {
            fault("F", print("found %.6g, expected a feed above 0", feed));
            state_.is_feed_unknown = true;
        } else if (!state_.is_inverse_time) {
            state_.feed = feed;
            state_.is_feed_in_start_unit = state_.is_unit_of_start && feed != 0;
            state_.feed_scale = state_.is_inch ? kMmPerInch : 1.0;
        }
    }
    if (block.code(spindle_mode) != -1) {
        state_.has_surface_speed = block.code(spindle_mode) == 960;
    }
    if (block.has('S')) {
        state_.spindle_rev_min = block.value('S');
        if (state_.spindle_rev_min < 0) {
            fault("S", print("found %.6g, expected a speed of 0 or more", block.value('S')));
        }
    }
    if (block.has('T')) {
        state_.selected_tool = tool_number('T');
    }
}

std::optional<std::uint16_t> GcodeInterpreter::tool_number(char letter) {
    const double value = block_->value(letter);
    if (value != std::floor(value) || value < 0 || value > 65535) {
        fault(std::string(1, letter), print("found %.6g, expected a tool number", value));
        return std::nullopt;
    }
    auto number = static_cast<std::uint16_t>(value);
    for (const auto& [program_number, machine_number] : options_.tools) {
        if (program_number == number) {
            number = machine_number;
            break;
        }
    }
    if (number != 0 && find_tool(number) == nullptr) {
        fault(std::string(1, letter).append(std::to_string(static_cast<int>(value))),
              "the machine file has no tool " + std::to_string(number) +
                  "; add it under tools, or map it with --tool " +
                  std::to_string(static_cast<int>(value)) + "=NUMBER");
        return std::nullopt;
    }
    return number;
}

const Tool* GcodeInterpreter::find_tool(std::uint16_t number) const {
    for (const Tool& tool : machine_.tools) {
        if (tool.number == number) {
            return &tool;
        }
    }
    return nullptr;
}

void GcodeInterpreter::change_tool() {
    if (block_->code(tool_change) != 60) {
        return;
    }
    if (!state_.selected_tool) {
        if (!block_->has('T')) {  // else the fault of T was reported
            fault("M6", "no tool was selected; write its T word first");
        }
        return;
    }
    state_.spindle_tool = *state_.selected_tool;
    ++result_.tool_changes;
    Move change = new_move(MoveKind::tool_change);
    change.tool = state_.spindle_tool;
    push(change);
}

void GcodeInterpreter::dwell() {
    if (block_->code(non_modal) != 40) {
        return;
    }
    const double seconds = block_->value('P', -1);
    if (seconds < 0 || seconds > 86400) {
        fault("G4", block_->has('P') ? print("P: found %.6g, expected 0 to 86400 seconds", seconds)
                                     : std::string("expected P, the seconds to wait"));
        return;
    }
    wait(seconds);
}

void GcodeInterpreter::wait_for_input() {
    const GcodeBlock& block = *block_;
    const std::int32_t code = block.code(outputs);
    if (code >= 670 && !block.has('E')) {
        fault(code == 670 ? "M67" : "M68", "expected E, the number of the output");
    }
    if (code != 660) {
        return;
    }
    if (block.has('P') == block.has('E')) {
        fault("M66", "expected P, a digital input, or E, an analog one");
        return;
    }
    wait(0);
}

void GcodeInterpreter::wait(double seconds) {
    Move next = new_move(MoveKind::dwell);
    next.dwell_s = seconds;
    std::vector<Move> moves;
    cutter_.add_pause(next, moves);
    release(moves);
}

void GcodeInterpreter::set_modes() {
    const GcodeBlock& block = *block_;
    if (block.code(plane) != -1) {
        state_.plane = block.code(plane);
    }
    if (block.code(units) != -1) {
        state_.is_inch = block.code(units) == 200;
        state_.is_unit_of_start = false;
    }
    set_cutter();
    set_tool_length();
    if (const std::int32_t code = block.code(offsets); code != -1) {
        state_.work_offset =
            static_cast<std::size_t>(code <= 590 ? (code - 540) / 10 : 5 + (code - 590));
    }
    if (is_rotated() && state_.control != kNoIndex) {
        refuse_rotated("tool centre point control");
    }
    if (const std::int32_t code = block.code(path); code != -1) {
        state_.is_exact = code != 640;
        state_.blend_mm = block.has('P') && code == 640 ? block.value('P') * scale() : -1;
        if (code == 640 && block.has('P') && state_.blend_mm < 0) {
            fault("G64", print("P: found %.6g, expected 0 or more", block.value('P')));
        }
    }
    if (block.code(distance) != -1) {
        state_.is_incremental = block.code(distance) == 910;
    }
    if (block.code(retract) != -1) {
        state_.retracts_to_r = block.code(retract) == 990;
    }
    if (block.code(arc_distance) != -1) {
        state_.has_absolute_centers = block.code(arc_distance) == 901;
    }
}

void GcodeInterpreter::forget_words() {
    const std::int32_t code = block_->code(non_modal);
    const bool writes = code == 100 || code == 520 || (code >= 920 && code <= 923) ||
                        block_->code(offsets) != -1 || block_->code(tool_length) != -1 ||
                        block_->code(units) != -1;
    for (std::uint32_t axis = 0; writes && axis < machine_.axes.size(); ++axis) {
        if (offset_of(axis) != 0) {
            state_.word_position[axis] = NAN;  // no position is equal
        }
    }
}

void GcodeInterpreter::assume(const std::string& setting) {
    if (std::find(result_.read_as.begin(), result_.read_as.end(), setting) ==
        result_.read_as.end()) {
        result_.read_as.push_back(setting);
    }
}

void GcodeInterpreter::use_lengths() {
    for (const char letter : {'X', 'Y', 'Z', 'U', 'V', 'W', 'I', 'J', 'K', 'R'}) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        const bool is_rotary = axis != kNoIndex && machine_.axes[axis].kind == AxisKind::rotary;
        if (block_->value(letter) != 0 && !is_rotary) {
            use_start_unit(letter);
            return;
        }
    }
    const bool is_cubic = block_->code(motion) == 50;
    if ((block_->code(path) == 640 || is_cubic) && block_->value('P') != 0) {
        use_start_unit('P');
    } else if (is_cubic && block_->value('Q') != 0) {
        use_start_unit('Q');
    }
}

void GcodeInterpreter::use_start_unit(char letter) {
    bool& is_of_start = letter == 'F' ? state_.is_feed_in_start_unit : state_.is_unit_of_start;
    if (!is_of_start) {
        return;
    }
    if (options_.program.starts_in_inch) {
        assume(*options_.program.starts_in_inch ? "starts in inch" : "starts in mm");
        return;
    }
    fault(std::string(1, letter),
          letter == 'F'
              ? "written before any G20 or G21 (of one line F is read first), and the machine file "
                "has no program.start_unit; state it there, or write G20 or G21 in a line before F"
              : "no G20 or G21 before this length, and the machine file has no "
                "program.start_unit; state it there, or write G20 or G21");
    is_of_start = false;  // said once
}

void GcodeInterpreter::stop() {
    if (block_->code(ModalGroup::stop) != -1) {
        flush_contour();
    }
    switch (block_->code(ModalGroup::stop)) {
        case 0:
        case 10:
            push(new_move(MoveKind::dwell));  // stops the axes
            break;
        case 20:
        case 300:
            state_.has_ended = true;
            break;
        default:
            break;
    }
}

void GcodeInterpreter::fault(const std::string& word, std::string message) {
    result_.faults.push_back({block_->line, word, std::move(message)});
}

}  // namespace axg
