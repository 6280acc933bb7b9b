// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_reader.hpp"

#include <algorithm>
#include <cctype>
#include <deque>
#include <set>
#include <span>

#include "config/text/small_file.hpp"
#include "config/text/text_line.hpp"
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

/// @param first_return  out: number of the first line that a CR alone ends, or 0
std::vector<std::string_view> lines_of(std::string_view text, std::size_t& first_return) {
    std::vector<std::string_view> lines;
    first_return = 0;
    while (!text.empty()) {
        bool is_lone_return = false;
        lines.push_back(take_text_line(text, &is_lone_return));
        if (is_lone_return && first_return == 0) {
            first_return = lines.size();
        }
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
          lines_(lines_of(text, first_return_)),
          own_lines_(lines_.size()),
          interpreter_(machine, options, result),
          parameters_([this](std::uint32_t index) { return interpreter_.parameter(index); }),
          flow_(with_sub_files(), file_starts_, parameters_) {}

    void run() {
        if (first_return_ != 0) {
            result_.notes.push_back(std::to_string(first_return_) +
                                    ": a carriage return alone ends the line; LinuxCNC reads it as "
                                    "a blank: convert the line ends");
            result_.read_as.emplace_back("CR alone ends a line");
        }
        run_startup_code();
        std::size_t next = 0;
        std::uint64_t steps = 0;
        while (!is_file_end(next) && !has_ended()) {
            const std::size_t line = next++;
            if (++steps > options_.steps_max) {
                fault(line, "program",
                      "more than " + std::to_string(options_.steps_max) +
                          " lines were run; check for an endless loop, or raise the limit with "
                          "--max-lines N");
                return;
            }
            const std::size_t faults_before = result_.faults.size();
            const bool goes_on = run_line(line, next);
            name_sub_file(line, faults_before);
            // Lines that a jump skips count as read.
            result_.line_count = std::max(result_.line_count,
                                          static_cast<std::uint32_t>(std::min(next, own_lines_)));
            if (!goes_on) {
                return;
            }
            if (result_.faults.size() >= options_.faults_max) {
                result_.has_more_faults = !is_file_end(next);
                return;
            }
        }
        if (!interpreter_.has_ended() && interpreter_.is_contour_open()) {
            fault(std::min(next, own_lines_) - 1, "G40",
                  "the program ends under cutter compensation, and LinuxCNC would not finish its "
                  "last move; end it with G40, M2 or M30");
        }
        if (interpreter_.is_nurbs_open()) {
            fault(std::min(next, own_lines_) - 1, "G5.2",
                  "the program ends between G5.2 and G5.3, and LinuxCNC would not move along the "
                  "curve; end it with G5.3");
        }
        if (!has_ended() && flow_.is_in_call()) {
            fault(std::min(next, own_lines_) - 1, "O",
                  "the file ends inside a subroutine; end it with endsub, or M99 after M98");
        } else if (!has_ended()) {
            result_.notes.push_back(std::to_string(result_.line_count) +
                                    ": the program ends without M2, M30 or a second %");
        }
    }

  private:
    [[nodiscard]] bool has_ended() const { return interpreter_.has_ended() || percents_ >= 2; }

    void fault(std::size_t line, std::string word, std::string message) {
        result_.faults.push_back({number_of(line), std::move(word), std::move(message)});
    }

    /// Appends the files of subroutines that are not in the program.
    std::span<const std::string_view> with_sub_files() {
        std::set<std::string> tried;
        bool is_new = !options_.sub_folders.empty();
        while (is_new) {
            is_new = false;
            for (const std::string& id : GcodeFlow::missing_subs(lines_)) {
                if (tried.insert(id).second && read_sub_file(id)) {
                    is_new = true;
                }
            }
        }
        return lines_;
    }

    bool read_sub_file(const std::string& id) {
        constexpr std::size_t kSubBytesMax = 16U << 20U;
        std::string name;
        for (const char c : id) {
            if (c != '<' && c != '>') {
                name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            }
        }
        if (name.find('/') != std::string::npos) {
            return false;
        }
        name += ".ngc";
        for (const std::string& folder : options_.sub_folders) {
            std::string text;
            const SmallFileFault fault = read_small_file(folder + "/" + name, kSubBytesMax, text);
            if (fault.got.empty() && fault.wanted.empty()) {
                std::size_t first_return = 0;
                const std::string& kept = sub_texts_.emplace_back(std::move(text));
                const std::vector<std::string_view> more = lines_of(kept, first_return);
                file_starts_.push_back(lines_.size());
                sub_names_.push_back(name);
                result_.subroutines += name + '\n' + kept;
                lines_.insert(lines_.end(), more.begin(), more.end());
                result_.read_as.push_back("subroutine " + printable_line(folder + "/" + name));
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] bool is_file_end(std::size_t next) const {
        return next >= lines_.size() || next == own_lines_ ||
               std::binary_search(file_starts_.begin(), file_starts_.end(), next);
    }

    /// Of the program: for a line of a subroutine's file, the line that calls it.
    [[nodiscard]] std::uint32_t number_of(std::size_t line) const {
        return static_cast<std::uint32_t>((line < own_lines_ ? line : last_own_line_) + 1);
    }

    /// New faults of a line in a subroutine's file begin with that file and line.
    void name_sub_file(std::size_t line, std::size_t faults_before) {
        if (line < own_lines_) {
            return;
        }
        const auto file = std::upper_bound(file_starts_.begin(), file_starts_.end(), line) - 1;
        const std::string place =
            sub_names_[static_cast<std::size_t>(file - file_starts_.begin())] + ":" +
            std::to_string(line - *file + 1) + ": ";
        for (std::size_t i = faults_before; i < result_.faults.size(); ++i) {
            result_.faults[i].message.insert(0, place);
        }
    }

    /// Its faults and moves have line 0.
    void run_startup_code() {
        const std::string& code = options_.program.startup_code;
        if (code.empty()) {
            return;
        }
        GcodeLine line = lex_gcode_line(code, &parameters_);
        // M52 P1: how fast the machine then goes is known to it alone, but no path depends on it.
        const bool has_adaptive_feed = std::erase_if(line.words, [](const GcodeWord& word) {
                                           return word.text == "M52" || word.text == "P1";
                                       }) == 2;
        result_.read_as.push_back("start-up code " + printable_line(code) +
                                  (has_adaptive_feed ? " (without M52 P1)" : ""));
        if (!line.flow.empty()) {
            line.fault_word.assign(1, 'O');
            line.fault = std::string("no O-word may be in it");
        }
        const GcodeBlock block = make_gcode_block(line, 0, options_.ignored, result_.faults);
        if (result_.faults.empty()) {
            interpreter_.run(block);
        }
        for (ProgramFault& fault : result_.faults) {
            fault.message += " (program.startup_code of the machine file)";
        }
    }

    /// Runs one line. False: the program cannot continue.
    bool run_line(std::size_t at, std::size_t& next) {
        last_own_line_ = at < own_lines_ ? at : last_own_line_;
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
            percents_ += at < own_lines_ ? 1 : 0;
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
            interpreter_.set_call_depth(flow_.calls(), number_of(at));
            if (wrong.empty() && flow_.is_number(at) && !options_.program.takes_program_numbers) {
                wrong =
                    "a program number, and the machine file has program.program_numbers: false; "
                    "delete the line";
            }
            if (!wrong.empty()) {
                fault(at, "O", std::move(wrong));
                list_words_after(at);
                return false;
            }
            return true;
        }
        run_block(at, line);
        return true;
    }

    /// Which lines run is unknown after a wrong O-word: lists the words of all others that no line
    /// may have, and wrong O-words, without running any.
    void list_words_after(std::size_t at) {
        while (++at < own_lines_) {
            if (result_.faults.size() >= options_.faults_max) {
                result_.has_more_faults = true;
                return;
            }
            const GcodeLine line = lex_gcode_line(lines_[at], &parameters_);
            std::string wrong = flow_.fault_of(at);
            if (!wrong.empty()) {
                fault(at, "O", std::move(wrong));
            } else if (line.fault.empty()) {
                const GcodeBlock block = make_gcode_block(line, static_cast<std::uint32_t>(at + 1),
                                                          options_.ignored, result_.faults);
                percents_ += line.is_percent ? 1 : 0;
                if (percents_ >= 2 || ends_program(block)) {
                    return;
                }
            }
        }
    }

    void run_block(std::size_t at, const GcodeLine& line) {
        const std::size_t faults_before = result_.faults.size();
        const std::uint32_t number = number_of(at);
        const GcodeBlock block = make_gcode_block(line, number, options_.ignored, result_.faults);
        for (const std::string& word : block.ignored) {
            result_.ignored.push_back({number, word, printable_line(lines_[at])});
        }
        for (const GcodeAssignment& one : line.assignments) {
            if (one.index == 0 && GcodeParameters::is_read_only(one.name)) {
                fault(at, std::string("#<").append(one.name).append(">"),
                      "only the control writes this parameter");
            } else if (one.index == 0) {
                parameters_.set_named(one.name, one.value);
            } else if (!parameters_.set_numbered(one.index, one.value)) {
                fault(at, std::string("#").append(std::to_string(one.index)),
                      "only the control writes this parameter; programs write 1 to 5060");
            }
        }
        if (result_.faults.size() == faults_before) {
            interpreter_.run(block);
            return;
        }
        interpreter_.skip_block();
        if (!faulty_lines_.insert(at).second) {
            result_.faults.resize(faults_before);  // a loop came again
        }
    }

    const GcodeOptions& options_;
    GcodeResult& result_;
    std::size_t first_return_ = 0;
    std::vector<std::string_view> lines_;  // of the program, then of its subroutines' files
    std::size_t own_lines_ = 0, last_own_line_ = 0;
    std::vector<std::size_t> file_starts_;
    std::vector<std::string> sub_names_;
    std::deque<std::string> sub_texts_;
    std::set<std::size_t> faulty_lines_;  // with a fault of their words, reported once
    GcodeInterpreter interpreter_;
    GcodeParameters parameters_;
    GcodeFlow flow_;
    std::uint32_t percents_ = 0;
};

}  // namespace

ProgramSettings usual_settings() {
    ProgramSettings settings;
    settings.starts_in_inch = false;
    settings.rotary.fill(RotaryRule::programmed);
    settings.g28.fill(0.0);
    settings.g30.fill(0.0);
    return settings;
}

std::string read_as_text(const std::vector<std::string>& read_as) {
    std::string text = read_as.empty() ? "read as written" : "read as: ";
    for (const std::string& one : read_as) {
        text += (&one == &read_as.front() ? "" : "; ") + one;
    }
    return text;
}

GcodeResult read_gcode(std::string_view text, const Machine& machine, const GcodeOptions& options) {
    GcodeResult result;
    Reading(text, machine, options, result).run();
    return result;
}

std::string read_axis_words(std::string_view text, const Machine& machine, AxisPositions& positions,
                            double* rotation_rad) {
    const GcodeLine line = lex_gcode_line(text);
    if (!line.fault.empty()) {
        return line.fault_word + ": " + line.fault;
    }
    for (const GcodeWord& word : line.words) {
        if (word.letter == 'R' && rotation_rad != nullptr) {
            *rotation_rad = word.number * kRadPerDegree;
            continue;
        }
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
