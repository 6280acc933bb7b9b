// SPDX-License-Identifier: Apache-2.0
// Which line of its program a trace is at: a table beside the trace, from `axguard simulate`. It
// contains the blocks too, so no stop needs the program itself.
// Source: docs/guide/simulate.md.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace axg {

/// From this instant of the trace on, up to the next step's.
struct ProgramStep {
    std::int64_t time_us = 0;
    std::uint32_t line = 0;  // 0: before the first move
    std::string block;       // the text of that line, without blanks at its ends
};

struct ProgramLines {
    std::string program{};             // its file, as it was named
    std::string read_as{};             // under which settings of the control
    std::uint32_t program_crc = 0;     // of its content
    std::uint64_t trace_bytes = 0;     // of the trace that the table belongs to
    std::uint32_t trace_crc = 0;       // crc32 of it
    std::vector<ProgramStep> steps{};  // in order of time

    [[nodiscard]] bool is_empty() const noexcept { return steps.empty(); }
};

/// The table's file: the trace's name and ".lines".
[[nodiscard]] std::string program_lines_name(const std::string& trace);

/// Begins a step where the line differs from the last one.
void add_program_step(ProgramLines& lines, std::int64_t time_us, std::uint32_t line);
/// Size and checksum of the trace that the table is for.
void set_trace(ProgramLines& lines, const std::string& trace);
/// The block of each step's line, and the checksum of the program.
void add_blocks(ProgramLines& lines, std::string_view program_text);

[[nodiscard]] std::string program_lines_text(const ProgramLines& lines);
/// @return  empty, or why `out` is empty: what is wrong with the text, and what to do
[[nodiscard]] std::string read_program_lines(const std::string& name, std::string_view text,
                                             ProgramLines& out);
/// The table of a trace, from `path` or from its own name. Missing under its own name: empty, and
/// no message.
/// @return  empty, or a message
[[nodiscard]] std::string load_program_lines(const std::string& trace, const std::string& path,
                                             ProgramLines& out);

/// Whether the program's file is there and has not changed since.
[[nodiscard]] bool is_program_of(const ProgramLines& lines);

/// The step at an instant; null: before the first one, or of line 0.
[[nodiscard]] const ProgramStep* step_at(const ProgramLines& lines, std::int64_t time_us) noexcept;
/// "  FILE:LINE: BLOCK" and the end of the line, for a terminal; empty: no step.
[[nodiscard]] std::string format_step_at(const ProgramLines& lines, std::int64_t time_us);

}  // namespace axg
