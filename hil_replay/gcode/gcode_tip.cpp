// SPDX-License-Identifier: Apache-2.0
// Tool offsets and tool centre point control: G43, G43.1, G43.4, G49, M428, M429. M428 and M429 are
// the words of LinuxCNC's switchable kinematics, G43.4 and G49 those of Fanuc.
// Source: LinuxCNC "G-codes" and "Switchable Kinematics"; docs/reference/gcode.md.
#include <algorithm>

#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {

using enum ModalGroup;

void GcodeInterpreter::set_tool_length() {
    const std::int32_t code = block_->code(tool_length);
    const std::int32_t switched = block_->code(kinematics);
    if (code == -1 && switched == -1) {
        return;
    }
    const std::optional<AxisPositions> offset = tool_offset(code);
    if (!offset) {
        return;
    }
    if (code != -1) {
        state_.has_length_control = code == 434;
    }
    if (switched != -1) {
        state_.has_kinematics_control = switched == 4280;
    }
    change_coordinates(*offset, state_.has_length_control || state_.has_kinematics_control);
}

std::optional<AxisPositions> GcodeInterpreter::tool_offset(std::int32_t code) {
    if (code == -1) {
        return state_.tool_offset;
    }
    AxisPositions offset{};
    if (code == 490) {
        return offset;
    }
    if (code == 431) {
        offset = state_.tool_offset;  // axes without a word do not change
        for (const char letter : kAxisLetters) {
            if (block_->has(letter)) {
                const std::uint32_t axis = named_axis(letter);
                if (axis == kNoIndex) {
                    return std::nullopt;
                }
                offset[axis] = word_value(letter, machine_.axes[axis]);
            }
        }
        return offset;
    }
    std::optional<std::uint16_t> number = state_.spindle_tool;
    if (block_->has('H')) {
        number = tool_number('H');
        if (number == 0) {  // LinuxCNC 2.9, find_tool_index: that of the spindle
            number = state_.spindle_tool;
        }
    }
    if (!number) {
        return std::nullopt;
    }
    const Tool* tool = find_tool(*number);
    if (tool == nullptr && !block_->has('H')) {
        fault(code == 430 ? "G43" : "G43.4", "no tool in the spindle; write H, or T and M6 before");
        return std::nullopt;
    }
    const std::uint32_t z = axis_of_letter(machine_, 'Z');
    if (z != kNoIndex) {
        offset[z] = tool == nullptr ? 0 : tool->length_mm;
    }
    return offset;
}

void GcodeInterpreter::change_coordinates(const AxisPositions& offset, bool is_controlled) {
    const bool was_controlled = state_.control != kNoIndex;
    const bool is_same = offset == state_.tool_offset && is_controlled == was_controlled;
    state_.tool_offset = offset;
    if (is_same || (!is_controlled && !was_controlled)) {
        return;
    }
    if (is_controlled && !tip_control_) {
        TipControl control;
        const std::string wanting = TipControl::make(machine_, options_.part, control);
        if (!wanting.empty()) {
            fault(state_.has_length_control ? "G43.4" : "M428",
                  "tool centre point control: " + wanting +
                      "; correct the machine file, or ignore M428 with --ignore M428,M429");
            state_.has_length_control = state_.has_kinematics_control = false;
            return;
        }
        tip_control_ = control;
    }
    std::vector<TipControl>& controls = result_.program.controls;
    const AxisPositions programmed = state_.position;
    if (was_controlled) {
        AxisPositions axes;
        controls[state_.control].axes_at(standing_at(), axes);
        state_.position = axes;
    }
    state_.standing_at.reset();
    state_.control = kNoIndex;
    if (is_controlled) {
        tip_control_->set_tool_offset(offset);
        const auto known = std::find(controls.begin(), controls.end(), *tip_control_);
        state_.control = static_cast<std::uint32_t>(known - controls.begin());
        if (known == controls.end()) {
            controls.push_back(*tip_control_);
        }
        state_.position = tip_control_->commanded_at(state_.position);
    }
    push(new_move(MoveKind::coordinates));
    if (was_controlled && is_controlled) {
        state_.standing_at = state_.position;
        state_.position = programmed;  // no word changed the programmed position of the tip
        settle(state_.position, standing_at());
        if (state_.position == *state_.standing_at) {
            state_.standing_at.reset();
        }
    }
}

}  // namespace axg
