// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode_interpreter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/sincos.hpp"
#include "hil_replay/gcode_arc.hpp"
#include "hil_replay/gcode_block.hpp"
#include "hil_replay/gcode_state.hpp"
#include "hil_replay/gcode_travel.hpp"

namespace axg {
namespace {

using enum ModalGroup;

constexpr double kRadPerDegree = kPi / 180.0;
constexpr double kMmPerInch = 25.4;

std::string print(const char* format, double a) {
    char text[160];
    std::snprintf(text, sizeof text, format, a);
    return text;
}

class Interpreter {
  public:
    Interpreter(const Machine& machine, const GcodeOptions& options, GcodeResult& result)
        : machine_(machine), options_(options), result_(result) {
        state_.position = options.start;
        state_.spindle_tool = machine.first_tool;
        result_.program.start = options.start;
        result_.program.start_tool = machine.first_tool;
    }

    /// In the order of LinuxCNC's "Order of Execution": F counts in the unit that was on before the
    /// block.
    void run(const GcodeBlock& block) {
        block_ = &block;
        set_feed_and_tool();
        change_tool();
        dwell();
        set_modes();
        move();
        stop();
    }

    /// A block that did not run may have set F: a missing feed is then no news.
    void skip_block() { state_.is_feed_unknown = true; }

    [[nodiscard]] bool has_ended() const { return state_.has_ended; }

  private:
    void fault(const std::string& word, std::string message) {
        result_.faults.push_back({block_->line, word, std::move(message)});
    }

    void set_feed_and_tool() {
        const GcodeBlock& block = *block_;
        if (block.code(feed_mode) != -1) {
            state_.is_inverse_time = block.code(feed_mode) == 930;
        }
        if (block.has('F')) {
            const double feed = block.value('F');
            if (feed < 0) {
                fault("F", print("got %.6g, wanted a feed above 0", feed));
                state_.is_feed_unknown = true;
            } else if (!state_.is_inverse_time) {
                state_.feed = feed;
                state_.feed_scale = state_.is_inch ? kMmPerInch : 1.0;
            }
        }
        if (block.has('S') && block.value('S') < 0) {
            fault("S", print("got %.6g, wanted a speed of 0 or more", block.value('S')));
        }
        if (block.has('T')) {
            state_.selected_tool = tool_number('T');
        }
    }

    /// The number a T or H word means on this machine; a fault where it is none.
    std::optional<std::uint16_t> tool_number(char letter) {
        const double value = block_->value(letter);
        if (value != std::floor(value) || value < 0 || value > 65535) {
            fault(std::string(1, letter), print("got %.6g, wanted a tool number", value));
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

    [[nodiscard]] const Tool* find_tool(std::uint16_t number) const {
        for (const Tool& tool : machine_.tools) {
            if (tool.number == number) {
                return &tool;
            }
        }
        return nullptr;
    }

    void change_tool() {
        if (block_->code(tool_change) != 60) {
            return;
        }
        if (!state_.selected_tool) {
            if (!block_->has('T')) {  // else its own fault was reported
                fault("M6", "no tool was selected; write its T word first");
            }
            return;
        }
        state_.spindle_tool = *state_.selected_tool;
        ++result_.tool_changes;
        Move change = new_move(MoveKind::tool_change);
        change.tool = state_.spindle_tool;
        result_.program.moves.push_back(change);
    }

    void dwell() {
        if (block_->code(non_modal) != 40) {
            return;
        }
        const double seconds = block_->value('P', -1);
        if (seconds < 0 || seconds > 86400) {
            fault("G4", block_->has('P') ? print("P: got %.6g, wanted 0 to 86400 seconds", seconds)
                                         : std::string("wanted P, the seconds to wait"));
            return;
        }
        Move wait = new_move(MoveKind::dwell);
        wait.dwell_s = seconds;
        result_.program.moves.push_back(wait);
    }

    void set_modes() {
        const GcodeBlock& block = *block_;
        if (block.code(plane) != -1) {
            state_.plane = block.code(plane);
        }
        if (block.code(units) != -1) {
            state_.is_inch = block.code(units) == 200;
        }
        set_tool_length();
        if (const std::int32_t code = block.code(offsets); code != -1) {
            state_.work_offset =
                static_cast<std::size_t>(code <= 590 ? (code - 540) / 10 : 5 + (code - 590));
        }
        if (const std::int32_t code = block.code(path); code != -1) {
            state_.is_exact = code != 640;
            state_.blend_mm = block.has('P') && code == 640 ? block.value('P') * scale() : -1;
            if (code == 640 && block.has('P') && state_.blend_mm < 0) {
                fault("G64", print("P: got %.6g, wanted 0 or more", block.value('P')));
            }
        }
        if (block.code(distance) != -1) {
            state_.is_incremental = block.code(distance) == 910;
        }
        if (block.code(arc_distance) != -1) {
            state_.has_absolute_centers = block.code(arc_distance) == 901;
        }
    }

    void set_tool_length() {
        const std::int32_t code = block_->code(tool_length);
        if (code == 490) {
            state_.tool_length_mm = 0;
        } else if (code == 430) {
            std::optional<std::uint16_t> number = state_.spindle_tool;
            if (block_->has('H')) {
                number = tool_number('H');
            }
            if (!number) {
                return;
            }
            const Tool* tool = find_tool(*number);
            if (tool == nullptr && !block_->has('H')) {
                fault("G43", "no tool in the spindle; write H, or T and M6 before");
                return;
            }
            state_.tool_length_mm = tool == nullptr ? 0 : tool->length_mm;
        }
    }

    void move() {
        const GcodeBlock& block = *block_;
        const std::int32_t written = block.code(motion);
        if (block.code(non_modal) == 280) {
            if (written != -1) {
                fault("G28", "conflicts with a motion word in the same block; write two blocks");
                return;
            }
            go_home();
            return;
        }
        if (written != -1) {
            state_.motion = written;
        }
        const bool has_axis = std::any_of(std::begin(kAxisLetters), std::end(kAxisLetters),
                                          [&](char letter) { return block.has(letter); });
        const bool has_arc = block.has('I') || block.has('J') || block.has('K') || block.has('R');
        const bool is_arc_mode = state_.motion == 20 || state_.motion == 30;
        if (has_arc && !is_arc_mode) {
            fault("I J K R", "only G2 and G3 take these, and the motion mode is another");
            return;
        }
        if (block.is_machine && (is_arc_mode || state_.is_incremental || !has_axis)) {
            fault("G53", "wanted G0 or G1 with axis words and G90");
            return;
        }
        if (!has_axis && !has_arc) {
            return;
        }
        if (block.code(non_modal) == 40) {
            fault("G4", "conflicts with axis words in the same block; write two blocks");
            return;
        }
        if (state_.motion == 800) {
            fault("G80", "axis words without a motion mode; write G0, G1, G2 or G3");
            return;
        }
        Move next = new_move(is_arc_mode ? MoveKind::arc : MoveKind::line);
        if (!set_target(next.target) || !set_feed(next) || (is_arc_mode && !set_arc(next))) {
            return;
        }
        append(next);
    }

    [[nodiscard]] double scale() const { return state_.is_inch ? kMmPerInch : 1.0; }

    [[nodiscard]] double word_value(char letter, const Axis& axis) const {
        return block_->value(letter) * (axis.kind == AxisKind::rotary ? kRadPerDegree : scale());
    }

    bool set_target(AxisPositions& target) {
        bool is_good = true;
        for (const char letter : kAxisLetters) {
            if (!block_->has(letter)) {
                continue;
            }
            const std::uint32_t index = axis_of_letter(machine_, letter);
            if (index == kNoIndex) {
                fault(std::string(1, letter), "the machine has no axis of this name");
                is_good = false;
                continue;
            }
            const double value = word_value(letter, machine_.axes[index]);
            if (state_.is_incremental) {
                target[index] = state_.position[index] + value;
            } else if (block_->is_machine) {
                target[index] = value;
            } else {
                target[index] = value + options_.work_offsets[state_.work_offset][index] +
                                (letter == 'Z' ? state_.tool_length_mm : 0.0);
            }
        }
        return is_good;
    }

    bool set_feed(Move& next) {
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
        if (!(state_.feed > 0)) {
            if (state_.is_feed_unknown) {
                return false;
            }
            fault("F", "no feed is set; write F above 0 in this block or before it");
            return false;
        }
        bool moves_linear = state_.motion != 10;
        for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
            moves_linear = moves_linear || (machine_.axes[i].kind == AxisKind::linear &&
                                            next.target[i] != state_.position[i]);
        }
        next.feed_kind = FeedKind::per_minute;
        next.feed = state_.feed * (moves_linear ? state_.feed_scale : 1.0);
        return true;
    }

    bool set_arc(Move& next) {
        struct Plane {
            char first, second, center_first, center_second, center_other;
        };
        const Plane plane_letters = state_.plane == 170   ? Plane{'X', 'Y', 'I', 'J', 'K'}
                                    : state_.plane == 180 ? Plane{'Z', 'X', 'K', 'I', 'J'}
                                                          : Plane{'Y', 'Z', 'J', 'K', 'I'};
        const std::string word = state_.motion == 20 ? "G2" : "G3";
        next.arc.first = axis_of_letter(machine_, plane_letters.first);
        next.arc.second = axis_of_letter(machine_, plane_letters.second);
        if (next.arc.first == kNoIndex || next.arc.second == kNoIndex ||
            machine_.axes[next.arc.first].kind != AxisKind::linear ||
            machine_.axes[next.arc.second].kind != AxisKind::linear) {
            fault(word, std::string("the machine has no linear axes ") + plane_letters.first +
                            " and " + plane_letters.second + " for this plane");
            return false;
        }
        if (block_->has(plane_letters.center_other)) {
            fault(word,
                  std::string(1, plane_letters.center_other) + " is not in the plane of the arc");
            return false;
        }
        const bool has_center =
            block_->has(plane_letters.center_first) || block_->has(plane_letters.center_second);
        if (has_center == block_->has('R')) {
            fault(word, has_center ? "got both R and a centre, wanted one of them"
                                   : "wanted R, or the centre as I J K of the plane");
            return false;
        }
        ArcWords words;
        words.start_first = state_.position[next.arc.first];
        words.start_second = state_.position[next.arc.second];
        words.end_first = next.target[next.arc.first];
        words.end_second = next.target[next.arc.second];
        words.has_radius = !has_center;
        words.radius = block_->value('R') * scale();
        words.center_first = arc_center(plane_letters.center_first, plane_letters.first);
        words.center_second = arc_center(plane_letters.center_second, plane_letters.second);
        words.is_clockwise = state_.motion == 20;
        words.is_inch = state_.is_inch;
        const double turns = block_->value('P', 1);
        if (turns != std::floor(turns) || turns < 1 || turns > 10000) {
            fault(word, print("P: got %.6g, wanted a whole number of turns from 1", turns));
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

    [[nodiscard]] double arc_center(char center_letter, char axis_letter) const {
        const std::uint32_t axis = axis_of_letter(machine_, axis_letter);
        const double value = block_->value(center_letter) * scale();
        if (state_.has_absolute_centers) {
            return value + options_.work_offsets[state_.work_offset][axis] +
                   (axis_letter == 'Z' ? state_.tool_length_mm : 0.0);
        }
        return value + state_.position[axis];
    }

    /// By way of the words, if any, then to machine zero: the named axes, or all of them.
    void go_home() {
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
        for (const char letter : kAxisLetters) {
            const std::uint32_t axis = axis_of_letter(machine_, letter);
            if (axis != kNoIndex && (!has_words || block_->has(letter))) {
                home.target[axis] = 0;
            }
        }
        append(home);
    }

    void stop() {
        switch (block_->code(ModalGroup::stop)) {
            case 0:
            case 10:
                result_.program.moves.push_back(new_move(MoveKind::dwell));  // comes to rest
                break;
            case 20:
            case 300:
                state_.has_ended = true;
                break;
            default:
                break;
        }
    }

    [[nodiscard]] Move new_move(MoveKind kind) const {
        Move next;
        next.kind = kind;
        next.is_exact = state_.is_exact || kind != MoveKind::line;
        next.blend_mm = state_.blend_mm;
        next.line = block_->line;
        next.tool = state_.spindle_tool;
        next.target = state_.position;
        return next;
    }

    void append(const Move& next) {
        check_travel(machine_, state_.position, next, result_.faults);
        const bool is_still = next.kind == MoveKind::line && next.target == state_.position;
        state_.position = next.target;
        if (is_still) {
            return;
        }
        if (result_.program.moves.size() >= kProgramMovesMax) {
            fault("program",
                  "longer than " + std::to_string(kProgramMovesMax) + " moves; split it");
            state_.has_ended = true;
            return;
        }
        result_.program.moves.push_back(next);
    }

    const Machine& machine_;
    const GcodeOptions& options_;
    GcodeResult& result_;
    GcodeState state_;
    const GcodeBlock* block_ = nullptr;
};

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
    Interpreter interpreter(machine, options, result);
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
