// SPDX-License-Identifier: Apache-2.0
// The words that write offsets: G10 L2 and L20, G52, G92 to G92.3.
// Source: LinuxCNC "G-codes"; tests/oracle/rs274_test.py compares them with its interpreter.
#include <cmath>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_interpreter.hpp"

namespace axg {

using enum ModalGroup;

void GcodeInterpreter::write_offsets() {
    const GcodeBlock& block = *block_;
    const std::int32_t code = block.code(non_modal);
    if (block.code(tool_length) == 431 && (block.code(motion) != -1 || code != -1)) {
        fault("G43.1", "takes the axis words of its block; write other words in another block");
        return;
    }
    if (code == 100) {
        write_work_offset();
        return;
    }
    if (code == 921 || code == 922) {
        state_.local_offset = {};
        state_.kept_local_offset = code == 921 ? AxisPositions{} : state_.kept_local_offset;
        return;
    }
    if (code == 923) {
        state_.local_offset = state_.kept_local_offset;
        return;
    }
    if (code != 520 && code != 920) {
        return;
    }
    const char* const word = code == 520 ? "G52" : "G92";
    bool has_axis = false;
    const AxisPositions programmed = programmed_position();
    for (const char letter : kAxisLetters) {
        if (!block.has(letter)) {
            continue;
        }
        const std::uint32_t axis = named_axis(letter);
        if (axis == kNoIndex) {
            return;
        }
        if (code == 920 && is_unknown_after_probe(letter, axis)) {
            return;
        }
        has_axis = true;
        double& offset = state_.local_offset[axis];
        const double value = word_value(letter, machine_.axes[axis]);
        offset = code == 520 ? value : programmed[axis] + offset - value;
    }
    if (!has_axis) {
        fault(word, "expected axis words with the position of the axes");
    }
    state_.kept_local_offset = state_.local_offset;
}

void GcodeInterpreter::rotate(AxisPositions& vector, bool is_back) const {
    const std::uint32_t x = axis_of_letter(machine_, 'X'), y = axis_of_letter(machine_, 'Y');
    if (!is_rotated() || x == kNoIndex || y == kNoIndex) {
        return;
    }
    const double angle = rotation_rad() * (is_back ? -1 : 1);
    const double cos = std::cos(angle), sin = std::sin(angle);
    const double along_x = vector[x] * cos - vector[y] * sin;
    vector[y] = vector[x] * sin + vector[y] * cos;
    vector[x] = along_x;
}

/// Source: LinuxCNC 2.9, emccanon.cc: G92's offset turns with the program, the tool's does not.
AxisPositions GcodeInterpreter::to_program(const AxisPositions& position) const {
    AxisPositions out = position;
    for (std::uint32_t axis = 0; axis < machine_.axes.size(); ++axis) {
        out[axis] -= is_rotated() ? offset_of(axis) - state_.local_offset[axis] : offset_of(axis);
    }
    if (is_rotated()) {
        rotate(out, true);
        for (std::uint32_t axis = 0; axis < machine_.axes.size(); ++axis) {
            out[axis] -= state_.local_offset[axis];
        }
    }
    return out;
}

AxisPositions GcodeInterpreter::from_program(const AxisPositions& programmed) const {
    AxisPositions out = programmed;
    for (std::uint32_t axis = 0; axis < machine_.axes.size(); ++axis) {
        out[axis] += state_.local_offset[axis];
    }
    rotate(out);
    for (std::uint32_t axis = 0; axis < machine_.axes.size(); ++axis) {
        out[axis] += offset_of(axis) - state_.local_offset[axis];
    }
    return out;
}

void GcodeInterpreter::set_rotated_target(AxisPositions& target) {
    if (!is_rotated() || block_->is_machine || (!block_->has('X') && !block_->has('Y'))) {
        return;
    }
    AxisPositions programmed = programmed_position();
    for (const char letter : {'X', 'Y'}) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        if (axis != kNoIndex && block_->has(letter)) {
            const double value = word_value(letter, machine_.axes[axis]);
            programmed[axis] = state_.is_incremental ? programmed[axis] + value : value;
        }
    }
    programmed = from_program(programmed);
    for (const char letter : {'X', 'Y'}) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        if (axis != kNoIndex) {
            target[axis] = programmed[axis];
        }
    }
}

/// Source: LinuxCNC 2.9 and 2.10, interp_convert.cc, convert_setup: it turns the position without
/// G92's offset, and axes without a word then move.
void GcodeInterpreter::check_rotation(double rad_before) {
    bool has_local = false;
    for (const char letter : {'X', 'Y'}) {
        const std::uint32_t axis = axis_of_letter(machine_, letter);
        has_local = has_local || (axis != kNoIndex && state_.local_offset[axis] != 0);
    }
    if (has_local && rad_before != rotation_rad()) {
        fault(block_->code(offsets) != -1 ? "G54" : "G10",
              "the rotation of X and Y changes under G92 or G52: LinuxCNC would move axes that the "
              "block does not name; write G92.1 before it");
    }
}

void GcodeInterpreter::refuse_rotated(const std::string& word) {
    fault(word, "not supported in a rotated work offset (G10 L2 R); post the program rotated");
}

void GcodeInterpreter::write_work_offset() {
    const GcodeBlock& block = *block_;
    const double kind = block.value('L', -1), number = block.value('P', -1);
    if (kind != 2 && kind != 20) {
        fault("G10", block.has('L')
                         ? "L: only L2 and L20 are supported; tools are in the machine file"
                         : "expected L2 or L20");
        return;
    }
    if (number != std::floor(number) || number < 0 || number > kWorkOffsets) {
        fault("G10", "expected P from 1 (G54) to 9 (G59.3), or 0 for the active one");
        return;
    }
    const std::size_t place =
        number == 0 ? state_.work_offset : static_cast<std::size_t>(number) - 1;
    if (kind == 20 && (block.has('R') || is_rotated() || state_.rotations_rad[place] != 0)) {
        fault("G10", "L20 with a rotated work offset is not supported; write L2");
        return;
    }
    if (block.has('R')) {
        if (state_.control != kNoIndex) {
            refuse_rotated("G10");
            return;
        }
        state_.rotations_rad[place] = block.value('R') * kPi / 180;
    }
    for (const char letter : kAxisLetters) {
        if (!block.has(letter)) {
            continue;
        }
        const std::uint32_t axis = named_axis(letter);
        if (axis == kNoIndex) {
            return;
        }
        if (kind == 20 && is_unknown_after_probe(letter, axis)) {
            return;
        }
        const double value = word_value(letter, machine_.axes[axis]);
        const double rest = offset_of(axis) - state_.work_offsets[state_.work_offset][axis];
        state_.work_offsets[place][axis] = kind == 2 ? value : state_.position[axis] - value - rest;
    }
}

}  // namespace axg
