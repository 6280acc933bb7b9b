// SPDX-License-Identifier: Apache-2.0
// axguard simulate: a G-code program as the CAN trace that a motion board would leave.
// docs/gcode.md.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/load_machine.hpp"
#include "config/small_file.hpp"
#include "hil_replay/commands.hpp"
#include "hil_replay/gcode_reader.hpp"
#include "hil_replay/gcode_travel.hpp"
#include "hil_replay/help_example.hpp"
#include "hil_replay/json_output.hpp"
#include "hil_replay/machine_options.hpp"
#include "hil_replay/program_split.hpp"
#include "hil_replay/trace_simulation.hpp"

namespace axg {
namespace {

constexpr const char* kExample =
    "axguard simulate config/machines/paper-trunnion.yaml "
    "hil_replay/programs/paper-trunnion-demo.ngc "
    "-o demo.log";
constexpr const char* kPurpose = "G-code to jerk-limited motion to a CAN trace (docs/gcode.md)";

struct SimulateArguments {
    MachineOptions machine;
    std::string program, output;
    std::uint32_t sample_us = 0;
    bool is_fd = false, is_axis_by_axis = false;
    std::string start;
    std::vector<std::string> work_offsets, tools, ignored;
    std::string block_delete = "refuse", rapid_cap = "on";
    double blend_mm = MotionOptions{}.blend_mm;
    std::size_t faults_max = GcodeOptions{}.faults_max;
    JsonOutput json;
};

/// The machine without its surfaces: motion needs none.
bool load_machine_only(const MachineOptions& options, Machine& machine) {
    const std::vector<ConfigFault> faults = load_machine(options.file, machine);
    for (const ConfigFault& fault : faults) {
        std::fprintf(stderr, "%s\n", to_string(fault).c_str());
    }
    if (!faults.empty()) {
        std::fprintf(stderr, "%s: %zu faults; repair the file and try again: axguard check %s\n",
                     options.file.c_str(), faults.size(), options.file.c_str());
    }
    return faults.empty();
}

constexpr std::size_t kProgramBytesMax = 256U << 20U;

/// The program's text; a message on stderr where it cannot be read.
bool read_program(const std::string& path, std::string& text) {
    const SmallFileFault fault = read_small_file(path, kProgramBytesMax, text);
    const bool is_read = fault.got.empty() && fault.wanted.empty();
    if (!is_read) {
        std::fprintf(stderr, "%s: got %s, wanted %s\n", path.c_str(), fault.got.c_str(),
                     fault.wanted.c_str());
    }
    return is_read;
}

/// "150=1": two tool numbers.
bool read_tool_pair(const std::string& text, GcodeOptions& options) {
    unsigned program = 0, machine = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%u=%u%c", &program, &machine, &rest) != 2 || program > 65535 ||
        machine > 65535) {
        std::fprintf(stderr, "--tool: got \"%s\", wanted PROGRAM=MACHINE, such as 150=1\n",
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
    std::string fault = "wanted a work offset and axis words, such as \"G54 X10 Z-50\"";
    for (std::size_t i = 0; i < kWorkOffsets; ++i) {
        if (text.substr(0, space) == kNames[i]) {
            fault = read_axis_words(text.substr(space), machine, options.work_offsets[i]);
        }
    }
    if (!fault.empty()) {
        std::fprintf(stderr, "--work-offset: \"%s\": %s\n", text.c_str(), fault.c_str());
    }
    return fault.empty();
}

bool is_start_inside(const Machine& machine, const AxisPositions& start) {
    Move move;
    move.target = start;
    AxisPositions nowhere;
    nowhere.fill(NAN);  // equal to nothing: every axis is judged
    const std::vector<TravelExcess> outside = check_travel(machine, nowhere, move);
    for (const TravelExcess& excess : outside) {
        std::fprintf(stderr, "--start: %s: %s\n", machine.axes[excess.axis].name.c_str(),
                     describe_excess(machine, excess).c_str());
    }
    return outside.empty();
}

/// Everything of the command line that means something only with a machine at hand.
bool make_gcode_options(const SimulateArguments& arguments, const Machine& machine,
                        GcodeOptions& options) {
    options.start = default_start(machine);
    options.faults_max = arguments.faults_max;
    options.ignored = arguments.ignored;
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

/// What was wrong, left out or odd: one line each, on stderr.
void print_messages(const std::string& file, const GcodeResult& result) {
    for (const IgnoredWord& word : result.ignored) {
        std::fprintf(stderr, "%s:%u: %s: ignored, as asked: %s\n", file.c_str(), word.line,
                     word.word.c_str(), word.text.c_str());
    }
    if (!result.ignored.empty()) {
        std::fprintf(
            stderr,
            "%s: %zu words ignored: the motion is not the program's where they matter; without "
            "tool centre point control axis words are taken as joint positions\n",
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
        std::fprintf(stderr, "%s: reading stopped after %zu faults; --max-errors N shows more\n",
                     file.c_str(), result.faults.size());
    }
}

nlohmann::ordered_json describe_reading(const GcodeResult& result) {
    nlohmann::ordered_json document;
    document["lines"] = result.line_count;
    document["moves"] = result.program.moves.size();
    document["tool_changes"] = result.tool_changes;
    auto& ignored = document["ignored"] = nlohmann::ordered_json::array();
    for (const IgnoredWord& word : result.ignored) {
        ignored.push_back({{"line", word.line}, {"word", word.word}, {"text", word.text}});
    }
    auto& faults = document["faults"] = nlohmann::ordered_json::array();
    for (const ProgramFault& fault : result.faults) {
        faults.push_back({{"line", fault.line}, {"word", fault.word}, {"message", fault.message}});
    }
    document["more_faults"] = result.has_more_faults;
    document["notes"] = result.notes;
    return document;
}

nlohmann::ordered_json describe_motion(const SimulationSummary& summary, const Machine& machine) {
    nlohmann::ordered_json document;
    document["program_s"] = summary.program_s;
    document["path_mm"] = summary.path_mm;
    document["samples"] = summary.samples;
    document["frames"] = summary.frames;
    document["standstills"] = summary.runs;
    document["blended_corners"] = summary.blends;
    auto& axes = document["axes"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const LimitMeter::Peak& peak = summary.peaks[i];
        axes.push_back({{"name", axis.name},
                        {"speed_share", peak.speed / axis.speed_max},
                        {"acceleration_share", peak.acceleration / axis.acceleration_max},
                        {"jerk_share", peak.jerk / axis.jerk_max}});
    }
    return document;
}

void print_summary(std::FILE* out, const SimulateArguments& arguments, const Machine& machine,
                   const SimulationSummary& summary) {
    std::fprintf(out, "%s: %.3f s of program, %.1f mm of path, %llu samples, %llu frames\n",
                 arguments.output.c_str(), summary.program_s, summary.path_mm,
                 static_cast<unsigned long long>(summary.samples),
                 static_cast<unsigned long long>(summary.frames));
    std::fprintf(out, "%u stretches from standstill to standstill, %u corners blended\n",
                 summary.runs, summary.blends);
    std::fprintf(out, "axis  largest speed  acceleration  jerk  (%% of the axis limit)\n");
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const LimitMeter::Peak& peak = summary.peaks[i];
        std::fprintf(out, "%-4s  %13.1f  %12.1f  %4.1f\n", axis.name.c_str(),
                     100 * peak.speed / axis.speed_max,
                     100 * peak.acceleration / axis.acceleration_max,
                     100 * peak.jerk / axis.jerk_max);
    }
}

int run_simulate(const SimulateArguments& arguments) {
    Machine machine;
    if (!load_machine_only(arguments.machine, machine)) {
        return kExitInput;
    }
    if (arguments.is_fd) {
        machine.can.format = CanFormat::fd;
    }
    GcodeOptions options;
    if (!make_gcode_options(arguments, machine, options)) {
        return kExitUsage;
    }
    if (!is_start_inside(machine, options.start)) {
        return kExitInput;
    }
    SimulationOptions simulation;
    simulation.sample_us = arguments.sample_us == 0 ? machine.can.sample_us : arguments.sample_us;
    simulation.motion.blend_mm = arguments.blend_mm;
    simulation.motion.cap_rapids = arguments.rapid_cap == "on";
    if (simulation.sample_us % kMotionStepUs != 0) {
        std::fprintf(stderr, "--sample-us: got %u, wanted a multiple of 100\n",
                     simulation.sample_us);
        return kExitUsage;
    }
    std::string text;
    if (!read_program(arguments.program, text)) {
        return kExitInput;
    }
    GcodeResult reading = read_gcode(text, machine, options);
    print_messages(arguments.program, reading);
    nlohmann::ordered_json document;
    document["program"] = arguments.program;
    document["trace"] = arguments.output;
    document["sample_us"] = simulation.sample_us;
    document["axis_by_axis"] = arguments.is_axis_by_axis;
    document["reading"] = describe_reading(reading);
    if (!reading.faults.empty()) {
        std::fprintf(stderr, "%s: no trace written; correct the program, or see docs/gcode.md\n",
                     arguments.program.c_str());
        (void)write_json(arguments.json, document);
        return kExitInput;
    }
    if (arguments.is_axis_by_axis) {
        reading.program = split_by_axis(reading.program, machine);
    }
    const bool is_terminal = isatty(STDERR_FILENO) == 1;
    if (is_terminal) {
        simulation.progress = [&](double program_s, std::uint32_t line) {
            std::fprintf(stderr, "\rsimulated %.0f s of program, line %u of %u ", program_s, line,
                         reading.line_count);
        };
    }
    const SimulationSummary summary =
        simulate_trace(machine, reading.program, simulation, arguments.output);
    if (is_terminal) {
        std::fprintf(stderr, "\r%60s\r", "");
    }
    if (!summary.error.empty()) {
        std::fprintf(stderr, "%s:%s\n", arguments.program.c_str(), summary.error.c_str());
        return summary.exit_code;
    }
    document["motion"] = describe_motion(summary, machine);
    print_summary(arguments.json.words(), arguments, machine, summary);
    return write_json(arguments.json, document) ? kExitClean : kExitInput;
}

void add_program_options(CLI::App& command, SimulateArguments& arguments) {
    command.add_option("PROGRAM", arguments.program, "G-code program, LinuxCNC's dialect")
        ->required();
    command.add_option("-o,--output", arguments.output, "Trace to write (candump log)")->required();
    command.add_option(
        "--start", arguments.start,
        "Axis positions before the program, such as \"X0 Z50 C90\" (machine coordinates, mm and "
        "degrees; default: zero, or the end of the travel nearest to it)");
    command
        .add_option("--work-offset", arguments.work_offsets,
                    "Offset of a work coordinate system, such as \"G54 X10 Z-50\"; repeatable")
        ->take_all()
        ->expected(1);
    command
        .add_option("--tool", arguments.tools,
                    "Tool number in the program = in the machine file, such as 150=1; repeatable")
        ->take_all()
        ->expected(1);
    command
        .add_option("--ignore", arguments.ignored,
                    "Words to leave out, such as M428,M429; each is echoed where it stands")
        ->delimiter(',');
    command
        .add_option("--block-delete", arguments.block_delete,
                    "Lines that begin with '/': refuse, skip or run")
        ->check(CLI::IsMember({"refuse", "skip", "run"}))
        ->capture_default_str();
    command.add_option("--max-errors", arguments.faults_max, "Faults listed before reading stops")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<SimulateArguments>();
    CLI::App* command = app.add_subcommand("simulate", kPurpose);
    put_example_first(*command, kExample);
    add_machine_options(*command, arguments->machine);
    add_program_options(*command, *arguments);
    command
        ->add_option("--sample-us", arguments->sample_us,
                     "Sample period, a multiple of 100 (default: the machine file's, 1000)")
        ->check(CLI::Range(100, 1000000));
    command->add_flag("--fd", arguments->is_fd,
                      "Flexible data rate frames, whatever the file says");
    command->add_flag("--axis-by-axis", arguments->is_axis_by_axis,
                      "Move one axis after the other, in the machine file's order");
    command
        ->add_option("--rapid-cap", arguments->rapid_cap,
                     "on: program_speed_mm_min holds for G0 too; off: axis limits alone")
        ->check(CLI::IsMember({"on", "off"}))
        ->capture_default_str();
    command
        ->add_option("--blend-mm", arguments->blend_mm,
                     "Corner tolerance unless G64 P states one; 0: rest at every corner")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    add_json_option(*command, arguments->json);
    command->callback([arguments, &exit_code] { exit_code = run_simulate(*arguments); });
}

}  // namespace axg
