// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_arguments.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "config/text/fault_text.hpp"
#include "config/text/small_file.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "hil_replay/gcode/gcode_travel.hpp"
#include "hil_replay/motion/least_time.hpp"

namespace axg {
namespace {

constexpr std::size_t kProgramBytesMax = 256U << 20U;

/// "150=1": two tool numbers.
bool read_tool_pair(const std::string& text, GcodeOptions& options) {
    unsigned program = 0, machine = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%u=%u%c", &program, &machine, &rest) != 2 || program > 65535 ||
        machine > 65535) {
        std::fprintf(
            stderr,
            "--tool: invalid value (found \"%s\", expected PROGRAM=MACHINE, such as 150=1).\n",
            text.c_str());
        return false;
    }
    options.tools.emplace_back(static_cast<std::uint16_t>(program),
                               static_cast<std::uint16_t>(machine));
    return true;
}

/// "G54 X10 Z-50": the offset of the named work coordinate system.
bool read_work_offset(const std::string& text, const Machine& machine, GcodeOptions& options) {
    constexpr const char* kNames[kWorkOffsets] = {"G54", "G55",   "G56",   "G57",  "G58",
                                                  "G59", "G59.1", "G59.2", "G59.3"};
    const std::size_t space = std::min(text.find(' '), text.size());
    std::string fault = "expected a work offset and axis words, such as \"G54 X10 Z-50\"";
    for (std::size_t i = 0; i < kWorkOffsets; ++i) {
        if (text.substr(0, space) == kNames[i]) {
            fault = read_axis_words(text.substr(space), machine, options.work_offsets[i],
                                    &options.rotations_rad[i]);
        }
    }
    if (!fault.empty()) {
        std::fprintf(stderr, "--work-offset: \"%s\": %s\n", text.c_str(), fault.c_str());
    }
    return fault.empty();
}

/// Adds a fault if the motion certainly has more samples than allowed.
void check_length(const Machine& machine, const GcodeOptions& options, GcodeResult& result) {
    const double seconds_max = static_cast<double>(options.samples_max) * options.sample_us * 1e-6;
    const std::vector<Move>& moves = result.program.moves;
    const std::size_t beyond =
        first_move_beyond(result.program, make_motion_limits(machine), seconds_max);
    if (beyond < moves.size()) {
        result.faults.push_back(
            {moves[beyond].line, "program", too_many_samples(options.samples_max)});
    }
}

}  // namespace

bool make_gcode_options(const GcodeArguments& arguments, const Machine& machine,
                        const ProgramSettings& settings, GcodeOptions& options) {
    options.program = settings;
    if (!arguments.rotary.empty()) {
        options.program.rotary.fill(arguments.rotary == "short"     ? RotaryRule::shortest
                                    : arguments.rotary == "wrapped" ? RotaryRule::wrapped
                                                                    : RotaryRule::programmed);
    }
    options.start = default_start(machine);
    options.faults_max = arguments.faults_max;
    options.steps_max = arguments.lines_max;
    options.moves_max = arguments.moves_max;
    options.samples_max = arguments.samples_max;
    options.sample_us = machine.can.sample_us;
    options.ignored = arguments.ignored;
    options.sub_folders = arguments.subs;
    options.part = arguments.part;
    for (std::string& word : options.ignored) {
        for (char& c : word) {
            c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        }
    }
    options.block_delete = arguments.block_delete == "skip"  ? BlockDelete::skip
                           : arguments.block_delete == "run" ? BlockDelete::run
                                                             : BlockDelete::refuse;
    bool is_good = true;
    const std::string fault = read_axis_words(arguments.start, machine, options.start);
    if (!fault.empty()) {
        std::fprintf(stderr, "--start: %s\n", fault.c_str());
        is_good = false;
    }
    for (const std::string& text : arguments.tools) {
        is_good = read_tool_pair(text, options) && is_good;
    }
    for (const std::string& text : arguments.work_offsets) {
        is_good = read_work_offset(text, machine, options) && is_good;
    }
    return is_good;
}

bool is_start_inside(const Machine& machine, const AxisPositions& start) {
    Move move;
    move.target = start;
    AxisPositions nowhere;
    nowhere.fill(NAN);  // equal to no position: check_travel checks every axis
    const std::vector<TravelExcess> outside = check_travel(machine, nowhere, move);
    for (const TravelExcess& excess : outside) {
        std::fprintf(stderr, "--start: %s: %s\n", machine.axes[excess.axis].name.c_str(),
                     describe_excess(machine, excess).c_str());
    }
    return outside.empty();
}

void print_messages(const std::string& file, const GcodeResult& result) {
    for (const IgnoredWord& word : result.ignored) {
        std::fprintf(stderr, "%s:%u: %s: ignored (--ignore): %s\n", file.c_str(), word.line,
                     word.word.c_str(), word.text.c_str());
    }
    if (!result.ignored.empty()) {
        std::fprintf(stderr,
                     "%s: %zu words ignored; the simulated motion may differ from the program's. "
                     "Without tool centre point control, axis words are joint positions.\n",
                     file.c_str(), result.ignored.size());
    }
    for (const std::string& note : result.notes) {
        std::fprintf(stderr, "%s:%s\n", file.c_str(), note.c_str());
    }
    for (const ProgramFault& fault : result.faults) {
        std::fprintf(stderr, "%s:%u: %s: %s\n", file.c_str(), fault.line, fault.word.c_str(),
                     fault.message.c_str());
    }
    if (result.has_more_faults) {
        std::fprintf(stderr,
                     "%s: reading stopped after %zu faults. Show more with --max-errors N.\n",
                     file.c_str(), result.faults.size());
    }
}

bool read_program_text(const std::string& path, std::string& text) {
    const SmallFileFault fault = read_small_file(path, kProgramBytesMax, text);
    if (!fault.got.empty() || !fault.wanted.empty()) {
        std::fprintf(stderr, "%s: %s\n", path.c_str(),
                     fault_text("invalid file", fault.got, fault.wanted).c_str());
        return false;
    }
    return true;
}

bool read_program(const GcodeArguments& arguments, const Machine& machine,
                  const GcodeOptions& options, GcodeResult& result) {
    std::string text;
    if (!read_program_text(arguments.program, text)) {
        return false;
    }
    result = read_gcode(text, machine, options);
    if (result.faults.empty()) {
        check_length(machine, options, result);
    }
    print_messages(arguments.program, result);
    result.text = std::move(text);
    return true;
}

std::vector<Option> add_gcode_settings(const Command& command, GcodeArguments& arguments) {
    return {
        command.add_option(
            "--start", arguments.start,
            "axis positions before the program, such as \"X0 Z50 C90\" [default: a trace's first "
            "sample; else 0, or the nearest end of travel]"),
        command
            .add_option("--work-offset", arguments.work_offsets,
                        "offset of a work coordinate system, such as \"G54 X10 Z-50\"; repeatable")
            .repeatable(),
        command
            .add_option("--tool", arguments.tools,
                        "PROGRAM=MACHINE: map a tool number of the program to one of the machine "
                        "file, such as 150=1; repeatable")
            .repeatable(),
        command
            .add_option("--sub", arguments.subs,
                        "folder of subroutines in files of their own: O<name> call reads name.ngc; "
                        "repeatable")
            .repeatable(),
        command
            .add_option("--ignore", arguments.ignored,
                        "words to ignore, such as M428,M429; each occurrence is reported")
            .separated_by(','),
        command
            .add_option("--block-delete", arguments.block_delete,
                        "lines that begin with '/': refuse, skip or run")
            .one_of({"refuse", "skip", "run"})
            .shows_default(),
        command
            .add_option("--rotary", arguments.rotary,
                        "absolute words of endless axes: full turns, less than half a turn, or up "
                        "and with a minus down [default: program.rotary of the machine file]")
            .one_of({"programmed", "short", "wrapped"}),
        command.add_option("--part", arguments.part,
                           "body that carries the part, for tool centre point control [default: "
                           "the body that most axes move]"),
        command
            .add_option("--max-errors", arguments.faults_max,
                        "number of faults after which reading stops")
            .between(1, 1000000)
            .shows_default(),
        command
            .add_option("--max-lines", arguments.lines_max,
                        "largest number of lines to run, repeated lines included")
            .between(std::int64_t{1}, std::int64_t{1'000'000'000'000})
            .shows_default(),
        command.add_option("--max-moves", arguments.moves_max, "largest number of moves in memory")
            .between(std::int64_t{1}, static_cast<std::int64_t>(kProgramMovesMax))
            .shows_default()};
}

void add_gcode_options(const Command& command, GcodeArguments& arguments) {
    command.add_input("PROGRAM", arguments.program, "G-code program in LinuxCNC's dialect")
        .required();
    add_gcode_settings(command, arguments);
    add_samples_limit(command, arguments);
}

void add_samples_limit(const Command& command, GcodeArguments& arguments) {
    command
        .add_option("--max-samples", arguments.samples_max,
                    "largest number of samples of the motion")
        .between(std::int64_t{1}, std::int64_t{1'000'000'000'000})
        .shows_default();
}

}  // namespace axg
