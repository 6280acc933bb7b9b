// SPDX-License-Identifier: Apache-2.0
// axguard-lab drive: runs a program on a simulated motion board, with guard or board made wrong on
// purpose. Uses the same loop as axguard drive.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/drive/drive_report.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "hil_replay/replay/read_faults.hpp"

namespace axg {
namespace {

struct AblatedDrive {
    MachineOptions machine;
    GcodeArguments gcode;
    std::vector<std::string> ablations;
    std::string faults;
    std::uint64_t seed = 1;
    JsonOutput json;

    [[nodiscard]] bool ablates(const char* name) const {
        return std::find(ablations.begin(), ablations.end(), name) != ablations.end();
    }
};

/// Returns kExitClean, or another exit code after printing the fault to stderr.
int read_inputs(const AblatedDrive& run, const LoadedMachine& loaded, DriveOptions& options,
                GcodeResult& reading) {
    const std::string bad_faults = read_faults(run.faults, options.faults);
    if (!bad_faults.empty()) {
        fmt::print(stderr, "--faults: {}\n", bad_faults);
        return kExitUsage;
    }
    const Machine& machine = loaded.machine;
    GcodeOptions gcode;
    if (!make_gcode_options(run.gcode, machine, program_settings(loaded.source, machine), gcode)) {
        return kExitUsage;
    }
    if (!is_start_inside(machine, gcode.start) ||
        !read_program(run.gcode, machine, gcode, reading) || !reading.faults.empty()) {
        return kExitInput;
    }
    return kExitClean;
}

int run_ablated(const AblatedDrive& run) {
    LoadedMachine loaded;
    if (const int code = load(run.machine, loaded); code != kExitClean) {
        return code;
    }
    const Machine& machine = loaded.machine;
    DriveOptions options;
    options.board = promised_board(machine, run.seed);
    options.board.tick_us = kMotionStepUs;
    options.response_us = machine.deadline_us;
    options.time_us_max = static_cast<std::int64_t>(run.gcode.samples_max) * machine.can.sample_us;
    GcodeResult reading;
    const int fault = read_inputs(run, loaded, options, reading);
    if (fault != kExitClean) {
        return fault;
    }
    LoadedMachine of_guard = loaded;
    if (run.ablates("no-jerk")) {
        lab::forget_jerk_ramp(of_guard.machine);
    }
    if (run.ablates("no-dead-man")) {
        lab::forget_dead_man(options.board);
    }
    std::optional<CpuEngine> engine = make_engine(loaded);
    const auto containment_test = engine ? make_containment_test(loaded, *engine) : std::nullopt;
    std::optional<StopCertificate> certificate = make_stop_certificate(of_guard);
    if (!containment_test || !certificate) {
        fmt::print(stderr, "{}\n", engine ? kNoMemoryForProofs : kNoLaneSet);
        return kExitUnfit;
    }
    GuardChain chain(machine, engine->engine(), *containment_test, {&*certificate});
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    const Program& program = reading.program;
    PathJudge judge(machine, engine->engine(), *containment_test);
    DriveObservers observers;
    observers.watch = [&](std::int64_t time_us, std::span<const AxisMotion> axes) {
        judge.look(time_us, axes, machine.first_tool);
    };
    const DriveResult result =
        drive(machine, chain, {program.start.data(), machine.axes.size()},
              make_program_motion(program, limits, motion), options, observers);
    const std::string mode = "stoppable";
    DriveReport report{machine, engine->engine(), result, run.gcode.program, mode, run.seed};
    report.contact = judge.contact();
    for (const std::string& ablation : run.ablations) {
        fmt::print(run.json.words(), "ablation: {}\n", ablation);
    }
    print_drive(report, Detail::full, run.json.words());
    const int found = report.contact ? kExitCollision : kExitClean;
    return write_json(run.json, describe_drive(report)) ? found : kExitInternal;
}

}  // namespace

void add_ablated_drive(CommandLine& line) {
    const auto run = std::make_shared<AblatedDrive>();
    const Command command = line.add_command(
        "drive", "Run a program in closed loop with a deliberately faulty guard or board");
    command.set_example(
        "axguard-lab drive config/machines/paper-trunnion.yaml "
        "hil_replay/programs/paper-trunnion-demo.ngc --ablate no-dead-man --faults killed=0.3");
    add_machine_options(command, run->machine);
    add_gcode_options(command, run->gcode);
    command
        .add_option("--ablate", run->ablations,
                    "no-jerk: the guard ignores the jerk of braking; no-dead-man: the board keeps "
                    "moving after its permit expires; repeatable")
        .one_of({"no-jerk", "no-dead-man"})
        .required();
    command.add_option("--seed", run->seed, "seed of all random values").shows_default();
    command.add_option("--faults", run->faults, "bus faults, as for axguard drive");
    add_json_option(command, run->json);
    command.set_action([run] { return run_ablated(*run); });
}

}  // namespace axg
