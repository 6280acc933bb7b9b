// SPDX-License-Identifier: Apache-2.0
// O-words, M98 and M99: subroutines, conditions and loops of a program. Source: LinuxCNC "O codes";
// tests/oracle/rs274_test.py compares them with its interpreter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "hil_replay/gcode/gcode_values.hpp"

namespace axg {

enum class FlowWord : std::uint8_t {
    sub,
    endsub,
    call,
    return_,
    if_,
    elseif,
    else_,
    endif,
    while_,
    endwhile,
    do_,
    repeat,
    endrepeat,
    break_,
    continue_,
    number,  // nothing after it: a program's number, or where M98 goes
    m98,
    m99,
};

/// One O-line: "o<pocket> call [3]" is {line, file, "<POCKET>", call, "[3]"}; of "M98 P3" the id is
/// empty and the rest "P3".
struct FlowLine {
    std::size_t line = 0;  // from 0
    std::size_t file = 0;  // 0: the program's own
    std::string id;
    FlowWord word = FlowWord::endif;
    std::string rest;              // arguments, condition
    std::string computed_id = {};  // of a call: an expression instead of the id
};

class GcodeFlow {
  public:
    /// @param lines   of the program and its subroutine files, as written; they and `parameters`
    /// must outlive it
    /// @param starts  the first line of each subroutine file, ascending
    GcodeFlow(std::span<const std::string_view> lines, std::span<const std::size_t> starts,
              GcodeParameters& parameters);

    /// Runs the O-line at `line`.
    /// @param next  out: the next line to run; in: the line after this one
    /// @return  empty, or the fault; the program cannot continue after a fault
    [[nodiscard]] std::string run(std::size_t line, std::size_t& next);

    /// Names of subroutines that are called and not in these lines: "<POCKET>", "12".
    [[nodiscard]] static std::vector<std::string> missing_subs(
        std::span<const std::string_view> lines);
    [[nodiscard]] std::size_t calls() const;
    [[nodiscard]] bool is_in_call() const { return calls() != 0; }
    /// Whether the line has a program's number and nothing else.
    [[nodiscard]] bool is_number(std::size_t line) const;
    /// The fault of a wrong O-line, whether it runs or not; empty for any other line.
    [[nodiscard]] std::string fault_of(std::size_t line) const;

  private:
    struct Frame {
        const FlowLine* start = nullptr;  // call, while, do or repeat
        std::size_t return_to = 0;        // call: the line after it
        double remaining = 0;             // repeat, M98 L
        [[nodiscard]] bool is_call() const {
            return start->word == FlowWord::sub || start->word == FlowWord::number;
        }
    };

    [[nodiscard]] const FlowLine* find_after(const FlowLine& from,
                                             std::initializer_list<FlowWord> words) const;
    [[nodiscard]] bool read_values(const FlowLine& at, std::vector<double>& values);
    [[nodiscard]] bool read_condition(const FlowLine& at, bool& is_true);
    void pass_number();
    void run_sub(const FlowLine& at, std::size_t& next);
    /// The number that a call computes; empty, and a fault, if it is none.
    std::string computed_id(const FlowLine& at);
    void call(const FlowLine& at, std::size_t& next);
    void call_number(const FlowLine& at, std::size_t& next);
    void end_number(std::size_t& next);
    void end_call(const FlowLine& at, std::size_t& next);
    void choose(const FlowLine& at, std::size_t& next);
    void skip_to_endif(const FlowLine& at, std::size_t& next);
    void loop_while(const FlowLine& at, std::size_t& next);
    void loop_repeat(const FlowLine& at, std::size_t& next);
    void end_loop(const FlowLine& at, std::size_t& next);
    void leave_loop(const FlowLine& at, std::size_t& next);
    [[nodiscard]] const FlowLine* end_of(const FlowLine& start) const;
    [[nodiscard]] bool is_in(const FlowLine& start) const {
        return !frames_.empty() && frames_.back().start == &start;
    }

    GcodeParameters& parameters_;
    std::vector<FlowLine> flow_;
    std::unordered_map<std::size_t, std::size_t> place_of_line_;
    std::unordered_map<std::size_t, std::string> fault_of_line_;
    std::vector<Frame> frames_;
    std::string fault_;
};

}  // namespace axg
