// SPDX-License-Identifier: Apache-2.0
// axguard simulate: a G-code program as the CAN trace that a motion board would leave.
// docs/reference/gcode.md.
#include "hil_replay/commands/simulate_command.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "config/compiled/compiled_machine.hpp"
#include "config/text/quote_text.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/cli/progress.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/commands/commands.hpp"
#include "hil_replay/commands/commands_json.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"
#include "hil_replay/motion/program_split.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"

namespace axg {
namespace {

constexpr const char* kExample =
    "axguard simulate config/machines/paper-trunnion.yaml "
    "hil_replay/programs/paper-trunnion-demo.ngc "
    "-o demo.log";
constexpr const char* kPurpose =
    "Simulate a G-code program and write a CAN trace (docs/reference/gcode.md)";

struct SimulateArguments {
    MachineOptions machine;
    GcodeArguments gcode;
    std::string output, rapid_cap = "on";
    std::uint32_t sample_us = 0;
    bool is_fd = false, is_axis_by_axis = false;
    double blend_mm = MotionOptions{}.blend_mm;
    JsonOutput json;
};

void print_summary(std::FILE* out, const SimulateArguments& arguments, const Machine& machine,
                   const SimulationSummary& summary) {
    std::fprintf(out, "%s: %.3f s of program, %.1f mm of path, %llu samples, %llu frames\n",
                 arguments.output.c_str(), summary.program_s, summary.path_mm,
                 static_cast<unsigned long long>(summary.samples),
                 static_cast<unsigned long long>(summary.frames));
    std::fprintf(out, "%u segments from standstill to standstill, %u corners blended\n",
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

/// Beside a trace that is a file of its own. False: it was not written, and the reason is printed.
bool write_program_lines(const SimulateArguments& arguments, const GcodeResult& reading,
                         ProgramLines& lines) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(arguments.output, error)) {
        return true;
    }
    set_trace(lines, arguments.output);
    lines.program = arguments.gcode.program;
    lines.read_as = read_as_text(reading.read_as);
    add_blocks(lines, reading.text);
    return write_whole_file(program_lines_name(arguments.output), program_lines_text(lines),
                            stderr);
}

int run_simulate(const SimulateArguments& arguments) {
    Machine machine;
    MachineText source;
    if (const int code = load_without_meshes(arguments.machine, machine, source);
        code != kExitClean) {
        return code;
    }
    if (arguments.is_fd) {
        machine.can.format = CanFormat::fd;
    }
    GcodeOptions options;
    if (!make_gcode_options(arguments.gcode, machine, program_settings(source, machine), options)) {
        return kExitUsage;
    }
    if (!is_start_inside(machine, options.start)) {
        return kExitInput;
    }
    SimulationOptions simulation;
    simulation.sample_us = arguments.sample_us == 0 ? machine.can.sample_us : arguments.sample_us;
    simulation.samples_max = options.samples_max;
    options.sample_us = simulation.sample_us;
    simulation.motion.blend_mm = arguments.blend_mm;
    simulation.motion.cap_rapids = arguments.rapid_cap == "on";
    if (simulation.sample_us % kMotionStepUs != 0) {
        std::fprintf(stderr, "--sample-us: invalid value (found %u, expected a multiple of 100).\n",
                     simulation.sample_us);
        return kExitUsage;
    }
    GcodeResult reading;
    if (!read_program(arguments.gcode, machine, options, reading)) {
        return kExitInput;
    }
    const SimulateReport report{arguments.gcode.program, arguments.output, simulation.sample_us,
                                arguments.is_axis_by_axis, reading};
    if (!reading.faults.empty()) {
        std::fprintf(stderr,
                     "%s: no trace written. Correct the program, or see docs/reference/gcode.md.\n",
                     arguments.gcode.program.c_str());
        (void)write_json(arguments.json, describe_simulate(report, machine, nullptr));
        return kExitInput;
    }
    if (arguments.is_axis_by_axis && !reading.program.controls.empty()) {
        std::fprintf(stderr,
                     "--axis-by-axis: conflicts with tool centre point control, which moves "
                     "several axes at once. Leave one of them out.\n");
        return kExitUsage;
    }
    std::optional<Program> split;
    if (arguments.is_axis_by_axis) {
        split = split_by_axis(reading.program, machine);
    }
    SimulationSummary summary =
        simulate_with_progress(machine, split ? *split : reading.program, reading.line_count,
                               simulation, arguments.output);
    if (!summary.error.empty()) {
        // A message about a file that was not written contains its name already.
        const bool is_about_program = summary.exit_code == kExitInput;
        std::fprintf(stderr, "%s%s%s\n", is_about_program ? arguments.gcode.program.c_str() : "",
                     is_about_program ? ":" : "", summary.error.c_str());
        return summary.exit_code;
    }
    if (!write_program_lines(arguments, reading, summary.lines)) {
        return kExitInternal;
    }
    print_summary(arguments.json.words(), arguments, machine, summary);
    fmt::print(arguments.json.words(), "{}: {}\n", arguments.gcode.program,
               read_as_text(reading.read_as));
    return write_json(arguments.json, describe_simulate(report, machine, &summary)) ? kExitClean
                                                                                    : kExitInternal;
}

}  // namespace

SimulationSummary simulate_with_progress(const Machine& machine, const Program& program,
                                         std::uint32_t line_count, SimulationOptions options,
                                         const std::string& output) {
    Progress progress;
    if (progress.is_terminal()) {
        options.progress = [&](double program_s, std::uint32_t line) {
            if (progress.is_due()) {
                progress.show(program_s, double(line) / line_count, fmt::format("line {}", line));
            }
        };
    }
    return simulate_trace(machine, program, options, output);
}

void add_simulate(CommandLine& line) {
    const auto arguments = std::make_shared<SimulateArguments>();
    const Command command = line.add_command("simulate", kPurpose);
    command.set_group("Try programs");
    command.set_example(kExample);
    add_machine_options(command, arguments->machine);
    add_gcode_options(command, arguments->gcode);
    command.add_output("-o,--output", arguments->output, "trace to write (candump log)").required();
    command
        .add_option(
            "--sample-us", arguments->sample_us,
            "sample period, a multiple of 100 us [default: can.sample_us of the machine file]")
        .between(100, 1000000);
    command.add_flag("--fd", arguments->is_fd,
                     "write CAN FD frames, regardless of the machine file");
    command.add_flag("--axis-by-axis", arguments->is_axis_by_axis,
                     "move one axis at a time, in the order of the machine file");
    command
        .add_option("--rapid-cap", arguments->rapid_cap,
                    "on: limit G0 to program_speed_mm_min too; off: only to the axis limits")
        .one_of({"on", "off"})
        .shows_default();
    command
        .add_option("--blend-mm", arguments->blend_mm,
                    "corner tolerance where no G64 P states one, mm; 0 = stop at every corner")
        .between(0.0, 10.0)
        .shows_default();
    add_json_option(command, arguments->json);
    command.set_action([arguments] {
        const std::string lines = program_lines_name(arguments->output);  // written too
        if (is_same_file(lines, arguments->gcode.program)) {
            fmt::print(stderr, "--output: {}: is the same file as PROGRAM. Pass another name.\n",
                       escaped(lines, 4096));
            return static_cast<int>(kExitUsage);
        }
        std::error_code error;
        const auto status = std::filesystem::status(lines, error);
        if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
            fmt::print(stderr,
                       "--output: {}: is no regular file, and the program's lines are written "
                       "there. Remove it, or pass another name.\n",
                       escaped(lines, 4096));
            return static_cast<int>(kExitUsage);
        }
        return run_simulate(*arguments);
    });
}

}  // namespace axg
