// SPDX-License-Identifier: Apache-2.0
// The words that write offsets: G10 L2 and L20, G52, G92 to G92.3.
// Source: LinuxCNC "G-codes"; tests/oracle/rs274_test.py compares them with its interpreter.
#include <cmath>

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
    for (const char letter : kAxisLetters) {
        if (!block.has(letter)) {
            continue;
        }
        const std::uint32_t axis = named_axis(letter);
        if (axis == kNoIndex) {
            return;
        }
        has_axis = true;
        double& offset = state_.local_offset[axis];
        const double value = word_value(letter, machine_.axes[axis]);
        offset = code == 520 ? value : state_.position[axis] - value - (offset_of(axis) - offset);
    }
    if (!has_axis) {
        fault(word, "expected axis words with the position of the axes");
    }
    state_.kept_local_offset = state_.local_offset;
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
    if (block.has('R')) {
        fault("G10", "R: a rotated work offset is not supported; post the program rotated");
        return;
    }
    const std::size_t place =
        number == 0 ? state_.work_offset : static_cast<std::size_t>(number) - 1;
    for (const char letter : kAxisLetters) {
        if (!block.has(letter)) {
            continue;
        }
        const std::uint32_t axis = named_axis(letter);
        if (axis == kNoIndex) {
            return;
        }
        const double value = word_value(letter, machine_.axes[axis]);
        const double rest = offset_of(axis) - state_.work_offsets[state_.work_offset][axis];
        state_.work_offsets[place][axis] = kind == 2 ? value : state_.position[axis] - value - rest;
    }
}

}  // namespace axg
