// SPDX-License-Identifier: Apache-2.0
// Options of a command line for a G-code program: the file, and settings that are otherwise in the
// control. Every command that reads a program has the same options. docs/reference/gcode.md.
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
    std::string program, start, part, block_delete = "refuse", rotary;
    std::vector<std::string> work_offsets, tools, subs, ignored;
    std::size_t faults_max = GcodeOptions{}.faults_max, moves_max = GcodeOptions{}.moves_max;
    std::uint64_t lines_max = GcodeOptions{}.steps_max, samples_max = GcodeOptions{}.samples_max;
};

void add_gcode_options(const Command& command, GcodeArguments& arguments);
/// Adds only the limit of samples.
void add_samples_limit(const Command& command, GcodeArguments& arguments);
/// Adds only the settings for reading, without the program and the limit of samples.
std::vector<Option> add_gcode_settings(const Command& command, GcodeArguments& arguments);

/// Converts the arguments to options for this machine. False: an argument is invalid; the message
/// on stderr shows the expected form.
/// @param settings  of the machine file; arguments overrule them
[[nodiscard]] bool make_gcode_options(const GcodeArguments& arguments, const Machine& machine,
                                      const ProgramSettings& settings, GcodeOptions& options);

/// Whether every axis starts within its travel; else prints the axes outside on stderr.
[[nodiscard]] bool is_start_inside(const Machine& machine, const AxisPositions& start);

/// Reads the program file. False: no such file, or too large; prints the fault on stderr.
[[nodiscard]] bool read_program_text(const std::string& path, std::string& text);
/// Prints ignored words, notes and faults on stderr, one per line.
void print_messages(const std::string& file, const GcodeResult& result);
/// Reads and interprets the program file, and prints its messages on stderr. False: the file cannot
/// be read. Faults of the program are in `result`.
[[nodiscard]] bool read_program(const GcodeArguments& arguments, const Machine& machine,
                                const GcodeOptions& options, GcodeResult& result);

}  // namespace axg
