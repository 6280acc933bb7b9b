// SPDX-License-Identifier: Apache-2.0
// Converts RS-274 in LinuxCNC's dialect to canonical moves in machine coordinates: modal state,
// units, offsets, tool lengths. docs/reference/gcode.md lists supported and refused words.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/machine/program_settings.hpp"
#include "hil_replay/motion/program.hpp"

namespace axg {

inline constexpr std::size_t kWorkOffsets = 9;             // G54..G59, G59.1..G59.3
inline constexpr std::size_t kProgramMovesMax = 1U << 23;  // largest moves_max: 2 GB

enum class BlockDelete : std::uint8_t {
    refuse,  // an error: a switch at the machine decides which blocks run; the user must choose
    skip,    // switch on: blocks with '/' do not run
    run,     // switch off: they run
};

/// Nothing unknown: mm, the programmed way, G28 and G30 to zero.
[[nodiscard]] ProgramSettings usual_settings();

struct GcodeOptions {
    AxisPositions start{};                                   // inside travel, mm or rad
    std::array<AxisPositions, kWorkOffsets> work_offsets{};  // mm or rad, zero unless stated
    std::array<double, kWorkOffsets> rotations_rad{};        // of X and Y about Z
    std::vector<std::string> sub_folders;                    // of subroutines in files of their own
    std::vector<std::string> ignored;  // "M428": words to skip, reported in the result
    std::vector<std::pair<std::uint16_t, std::uint16_t>>
        tools;         // program's number, machine's number
    std::string part;  // the body that carries the part; empty: the one that most axes move
    ProgramSettings program = usual_settings();
    BlockDelete block_delete = BlockDelete::refuse;
    std::size_t faults_max = 20;          // reading stops after this many
    std::uint64_t steps_max = 5'000'000;  // lines to run, repeated lines included
    std::size_t moves_max = 1'000'000;
    std::uint64_t samples_max = 10'000'000;  // 2.8 h at 1 ms, a trace of 1.7 GB
    std::uint32_t sample_us = 1000;
};

struct IgnoredWord {
    std::uint32_t line = 0;
    std::string word;
    std::string text;  // the line as written, control characters replaced
};

struct GcodeResult {
    std::string text;         // of the program, if read from a file
    std::string subroutines;  // name and text of each file that was read besides
    Program program;          // usable only without faults
    std::vector<ProgramFault> faults;
    bool has_more_faults = false;
    std::vector<IgnoredWord> ignored;
    // Settings of the control without which the program would mean something else: "starts in mm".
    std::vector<std::string> read_as;
    std::vector<std::string> notes;  // harmless oddities, as "12: ..."
    std::uint32_t line_count = 0;
    std::uint32_t tool_changes = 0;
};

/// Reads a whole program. Collects faults up to faults_max; never throws on content.
/// Rotary words are degrees, linear ones mm or inch. What options.program leaves unknown is a fault
/// where it would decide.
[[nodiscard]] GcodeResult read_gcode(std::string_view text, const Machine& machine,
                                     const GcodeOptions& options);

/// "read as: starts in mm; C programmed", or "read as written" without any.
[[nodiscard]] std::string read_as_text(const std::vector<std::string>& read_as);

/// Reads axis words such as "X0 Y-10.5 C90" (mm and degrees) into `positions`. Returns an empty
/// text on success, else the fault.
/// @param rotation_rad  of a word R; nullptr: R is a fault
[[nodiscard]] std::string read_axis_words(std::string_view text, const Machine& machine,
                                          AxisPositions& positions, double* rotation_rad = nullptr);

/// Zero for every axis, or the nearest end of its travel if zero is outside.
[[nodiscard]] AxisPositions default_start(const Machine& machine);

/// Index of the axis a letter names, or kNoIndex.
[[nodiscard]] std::uint32_t axis_of_letter(const Machine& machine, char letter);

}  // namespace axg
