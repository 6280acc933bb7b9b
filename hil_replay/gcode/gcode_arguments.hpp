// SPDX-License-Identifier: Apache-2.0
// What a command line says about a G-code program: which file, and what the control would know
// beside it. The same words for every command that reads one. docs/reference/gcode.md.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"

namespace axg {

class Command;
class Option;

struct GcodeArguments {
    std::string program, start, part, block_delete = "refuse", rotary = "programmed";
    std::vector<std::string> work_offsets, tools, ignored;
    std::size_t faults_max = GcodeOptions{}.faults_max, moves_max = GcodeOptions{}.moves_max;
    std::uint64_t lines_max = GcodeOptions{}.steps_max, samples_max = GcodeOptions{}.samples_max;
};

void add_gcode_options(const Command& command, GcodeArguments& arguments);
/// Of these all that reading needs besides the program.
std::vector<Option> add_gcode_settings(const Command& command, GcodeArguments& arguments);

/// Everything of it that means something only with a machine at hand. False: used wrongly, and
/// stderr has the form.
[[nodiscard]] bool make_gcode_options(const GcodeArguments& arguments, const Machine& machine,
                                      GcodeOptions& options);

/// Whether every axis starts within its travel; else stderr names the axis.
[[nodiscard]] bool is_start_inside(const Machine& machine, const AxisPositions& start);

/// The program file's content; a fault stands on stderr. False: no such file, or too large.
[[nodiscard]] bool read_program_text(const std::string& path, std::string& text);
/// What was wrong, left out or odd: a line each, on stderr.
void print_messages(const std::string& file, const GcodeResult& result);
/// Reads the program file; what was wrong, left out or odd stands on stderr, a line each. False: no
/// such file. Faults of the program are in `result`.
[[nodiscard]] bool read_program(const GcodeArguments& arguments, const Machine& machine,
                                const GcodeOptions& options, GcodeResult& result);

}  // namespace axg
