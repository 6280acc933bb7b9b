// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode_reader.hpp"

#include <algorithm>

#include "core/sincos.hpp"
#include "hil_replay/gcode_block.hpp"
#include "hil_replay/gcode_interpreter.hpp"

namespace axg {
namespace {

constexpr double kRadPerDegree = kPi / 180.0;

std::string printable_line(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 200)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte != '\r') {
            out.push_back(byte >= 0x20 && byte != 0x7f ? c : '?');
        }
    }
    return out;
}

}  // namespace

GcodeResult read_gcode(std::string_view text, const Machine& machine, const GcodeOptions& options) {
    GcodeResult result;
    GcodeInterpreter interpreter(machine, options, result);
    std::uint32_t percents = 0;
    while (!text.empty() && !interpreter.has_ended() && percents < 2) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line_text = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::uint32_t number = ++result.line_count;
        const GcodeLine line = lex_gcode_line(line_text);
        if (line.is_percent) {
            ++percents;
            continue;
        }
        const std::size_t faults_before = result.faults.size();
        if (line.block_delete && options.block_delete == BlockDelete::refuse) {
            result.faults.push_back(
                {number, "/",
                 "block delete: whether this line runs depends on a switch; say "
                 "--block-delete skip or --block-delete run"});
        } else if (!line.block_delete || options.block_delete == BlockDelete::run) {
            const GcodeBlock block = make_gcode_block(line, number, options.ignored, result.faults);
            for (const std::string& word : block.ignored) {
                result.ignored.push_back({number, word, printable_line(line_text)});
            }
            if (result.faults.size() == faults_before) {
                interpreter.run(block);
            } else {
                interpreter.skip_block();
            }
        }
        if (result.faults.size() >= options.faults_max) {
            result.has_more_faults = !text.empty();
            return result;
        }
    }
    if (!interpreter.has_ended() && percents < 2) {
        result.notes.push_back(std::to_string(result.line_count) +
                               ": the program ends without M2, M30 or a second %");
    }
    return result;
}

std::string read_axis_words(std::string_view text, const Machine& machine,
                            AxisPositions& positions) {
    const GcodeLine line = lex_gcode_line(text);
    if (!line.fault.empty()) {
        return line.fault_word + ": " + line.fault;
    }
    for (const GcodeWord& word : line.words) {
        const std::uint32_t axis = axis_of_letter(machine, word.letter);
        if (axis == kNoIndex) {
            return word.text + ": the machine has no axis of this name";
        }
        positions[axis] =
            word.number * (machine.axes[axis].kind == AxisKind::rotary ? kRadPerDegree : 1.0);
    }
    return {};
}

AxisPositions default_start(const Machine& machine) {
    AxisPositions start{};
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        start[i] = axis.unlimited ? 0.0 : std::clamp(0.0, axis.min, axis.max);
    }
    return start;
}

std::uint32_t axis_of_letter(const Machine& machine, char letter) {
    if (!is_axis_letter(letter)) {
        return kNoIndex;
    }
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        if (machine.axes[i].name.size() == 1 && machine.axes[i].name.front() == letter) {
            return i;
        }
    }
    return kNoIndex;
}

}  // namespace axg
