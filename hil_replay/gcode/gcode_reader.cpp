// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_reader.hpp"

#include <algorithm>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_block.hpp"
#include "hil_replay/gcode/gcode_dialect.hpp"
#include "hil_replay/gcode/gcode_flow.hpp"
#include "hil_replay/gcode/gcode_interpreter.hpp"

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

namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        lines.push_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

/// Runs one program line by line.
class Reading {
  public:
    Reading(std::string_view text, const Machine& machine, const GcodeOptions& options,
            GcodeResult& result)
        : options_(options),
          result_(result),
          lines_(lines_of(text)),
          interpreter_(machine, options, result),
          parameters_([this](std::uint32_t index) { return interpreter_.parameter(index); }),
          flow_(lines_, parameters_) {}

    void run() {
        std::size_t next = 0;
        std::uint64_t steps = 0;
        while (next < lines_.size() && !has_ended()) {
            const std::size_t line = next++;
            if (++steps > options_.steps_max) {
                fault(line, "program",
                      "more than " + std::to_string(options_.steps_max) +
                          " lines were run; check for an endless loop, or raise the limit with "
                          "--max-lines N");
                return;
            }
            const bool goes_on = run_line(line, next);
            // Lines that a jump skips count as read.
            result_.line_count = std::max(result_.line_count, static_cast<std::uint32_t>(next));
            if (!goes_on) {
                return;
            }
            if (result_.faults.size() >= options_.faults_max) {
                result_.has_more_faults = next < lines_.size();
                return;
            }
        }
        if (!has_ended()) {
            result_.notes.push_back(std::to_string(result_.line_count) +
                                    ": the program ends without M2, M30 or a second %");
        }
    }

  private:
    [[nodiscard]] bool has_ended() const { return interpreter_.has_ended() || percents_ >= 2; }

    void fault(std::size_t line, std::string word, std::string message) {
        result_.faults.push_back(
            {static_cast<std::uint32_t>(line + 1), std::move(word), std::move(message)});
    }

    /// Runs one line. False: the program cannot continue.
    bool run_line(std::size_t at, std::size_t& next) {
        const GcodeLine line = lex_gcode_line(lines_[at], &parameters_);
        const std::string_view control =
            line.fault.empty() ? std::string_view{} : foreign_control(lines_[at]);
        if (!control.empty()) {
            fault(at, "program",
                  std::string("written for a ")
                      .append(control)
                      .append(" control; only LinuxCNC's dialect (RS-274) is supported: post the "
                              "program for LinuxCNC"));
            return false;
        }
        if (line.is_percent) {
            ++percents_;
            return true;
        }
        if (line.block_delete && options_.block_delete == BlockDelete::refuse) {
            fault(at, "/",
                  "block delete: a switch decides whether this line runs; pass --block-delete skip "
                  "or --block-delete run");
            return true;
        }
        if (line.block_delete && options_.block_delete == BlockDelete::skip) {
            return true;
        }
        if (!line.flow.empty()) {
            std::string wrong = flow_.run(at, next);
            if (!wrong.empty()) {
                fault(at, "O", std::move(wrong));
                return false;
            }
            return true;
        }
        run_block(at, line);
        return true;
    }

    void run_block(std::size_t at, const GcodeLine& line) {
        const std::size_t faults_before = result_.faults.size();
        const auto number = static_cast<std::uint32_t>(at + 1);
        const GcodeBlock block = make_gcode_block(line, number, options_.ignored, result_.faults);
        for (const std::string& word : block.ignored) {
            result_.ignored.push_back({number, word, printable_line(lines_[at])});
        }
        for (const GcodeAssignment& one : line.assignments) {
            if (one.index == 0) {
                parameters_.set_named(one.name, one.value);
            } else if (!parameters_.set_numbered(one.index, one.value)) {
                fault(at, std::string("#").append(std::to_string(one.index)),
                      "only the control writes this parameter; programs write 1 to 5060");
            }
        }
        if (result_.faults.size() == faults_before) {
            interpreter_.run(block);
        } else {
            interpreter_.skip_block();
        }
    }

    const GcodeOptions& options_;
    GcodeResult& result_;
    std::vector<std::string_view> lines_;
    GcodeInterpreter interpreter_;
    GcodeParameters parameters_;
    GcodeFlow flow_;
    std::uint32_t percents_ = 0;
};

}  // namespace

GcodeResult read_gcode(std::string_view text, const Machine& machine, const GcodeOptions& options) {
    GcodeResult result;
    Reading(text, machine, options, result).run();
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
