// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench: measures this computer. The measured times do not affect the exit code.
#include <fmt/format.h>

#include <memory>

#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/cycle_work.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "hil_replay/lab/bench/cycle_benchmark.hpp"
#include "hil_replay/lab/bench/offline_benchmark.hpp"
#include "hil_replay/lab/bench/paper_benchmark.hpp"
#include "hil_replay/lab/bench/pose_benchmark.hpp"
#include "hil_replay/lab/bench/scene_benchmark.hpp"
#include "hil_replay/lab/bench/worst_case_benchmark.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPosesMax = 2000;  // a series of eight pairs has its own memory

struct BenchOptions {
    bool paper = false, worst_case = false, offline = false;
    PaperBenchmarkOptions experiment;
    SceneBenchmarkOptions scene;
    std::string machine, pose_machine, lanes, axis_data = "computed";
    std::uint32_t tree_levels = 0, launches = 1, stages = 0;
    std::uint32_t positions = 131'072;
    std::uint32_t pose_passes = 25, step = kPlanStepAsStated;
    bool has_cycles = false;
    std::string engine = "auto";
    JsonOutput json;
};

std::string usual_machine(const BenchOptions& options) {
    return options.experiment.data + "/config/machines/paper-trunnion.yaml";
}

/// Runs --worst-case: a machine's plan on this processor, or batches or a plan on a GPU.
int run_worst_case(const BenchOptions& options) {
    const std::string usual = usual_machine(options);
    if (options.engine != "cpu") {
        const bool is_usual = options.machine.empty() && options.stages != 0;
        return run_worst_case_benchmark({.machine = is_usual ? usual : options.machine,
                                         .tree_levels = options.tree_levels,
                                         .launches = options.launches,
                                         .stages = options.stages,
                                         .axis_data = options.axis_data,
                                         .sms = options.experiment.multiprocessors,
                                         .cycles = options.scene.cycles,
                                         .json = options.json});
    }
    return run_cycle_benchmark({.machine = options.machine.empty() ? usual : options.machine,
                                .lanes = options.lanes,
                                .cycles = options.has_cycles ? options.scene.cycles : 0,
                                .step = options.step,
                                .json = options.json});
}

int benchmark(const BenchOptions& options) {
    const int wanted = (options.paper ? 1 : 0) + (options.worst_case ? 1 : 0) +
                       (options.offline ? 1 : 0) + (options.scene.folder.empty() ? 0 : 1) +
                       (options.pose_machine.empty() ? 0 : 1);
    if (wanted != 1) {
        fmt::print(stderr,
                   "axguard-lab bench: missing argument (expected one of SCENE_DIR, --paper, "
                   "--worst-case, --offline or --pose)\n");
        return kExitUsage;
    }
    if (options.axis_data == "all" && !options.worst_case) {
        fmt::print(stderr, "axguard-lab bench: --axis-data all needs --worst-case\n");
        return kExitUsage;
    }
    if (!options.pose_machine.empty()) {
        return run_pose_benchmark(
            {.machine = options.pose_machine, .passes = options.pose_passes, .json = options.json});
    }
    if (options.worst_case) {
        return run_worst_case(options);
    }
    if (options.offline) {
        return run_offline_benchmark(
            {.machine = options.machine.empty() ? usual_machine(options) : options.machine,
             .positions = options.positions,
             .passes = options.experiment.passes,
             .margin_mm = options.scene.margin_mm,
             .json = options.json});
    }
    if (!options.paper) {
        SceneBenchmarkOptions scene = options.scene;
        scene.engine = options.engine;
        scene.sms = options.experiment.multiprocessors;
        scene.axis_data = options.axis_data;
        scene.json = options.json;
        return run_scene_benchmark(scene);
    }
    PaperBenchmarkOptions experiment = options.experiment;
    experiment.use_gpu = options.engine != "cpu";
    PaperBenchmark result;
    if (const int code = run_paper_benchmark(experiment, result, stderr); code != kExitClean) {
        return code;
    }
    print_paper_benchmark(result, options.json.words());
    if (options.engine == "cuda" && !result.no_gpu.empty()) {
        fmt::print(stderr, "axguard-lab bench: {}\n", result.no_gpu);
        return kExitGpu;
    }
    return write_json(options.json, describe_paper_benchmark(result)) ? kExitClean : kExitInternal;
}

void add_worst_case_options(const Command& command, BenchOptions& options) {
    command.add_flag("--worst-case", options.worst_case,
                     "measure the worst case, every list full: the longest GPU batch, or with "
                     "--engine cpu the longest cycle of a plan");
    command.add_flag("--offline", options.offline,
                     "measure large batches on a GPU: all pairs at many positions of a machine");
    command
        .add_option("--positions", options.positions,
                    "with --offline: positions spread over the travel")
        .between(1U, 10'000'000U)
        .shows_default();
    command.add_input("--machine", options.machine, "with --worst-case or --offline: machine file");
    command
        .add_option("--step", options.step,
                    "with --worst-case --engine cpu: plan to measure; 3 = plan of the machine file")
        .between(0U, kPlanSteps - 1);
    command
        .add_option("--lanes", options.lanes,
                    "with --worst-case --engine cpu: lane set [default: widest]")
        .one_of({"avx512", "avx2", "neon"});
    command.add_input("--pose", options.pose_machine,
                      "measure the time to pose the joint boxes of this machine's cycle");
    command
        .add_option("--levels", options.tree_levels,
                    "with --worst-case: levels of node pairs [default: from the machine's trees]")
        .between(1U, kTreeDepthMax);
    command
        .add_option("--launches", options.launches,
                    "with --worst-case: launches per cycle, each with all lists full")
        .between(1U, 64U)
        .shows_default();
    command
        .add_option("--stages", options.stages,
                    "with --worst-case: the longest cycle of a plan in N stages [default: batches]")
        .between(1U, kStagesMax);
    command
        .add_option("--axis-data", options.axis_data,
                    "GPU axis data; rolled: axis loops not unrolled; all: a column each")
        .one_of({"computed", "cached", "prefetched", "rolled", "all"})
        .shows_default();
}

}  // namespace

void add_bench(CommandLine& line) {
    auto options = std::make_shared<BenchOptions>();
    options->experiment.data = AXG_DATA_DIR;
    const Command command = line.add_command("bench", "Measure the engines on this host");
    command.set_example("axguard-lab bench --paper --poses 400");
    command.add_option(
        "SCENE_DIR", options->scene.folder,
        "scene to measure: folder with bodies.csv, pairs.csv, poses.csv and STL files");
    command.add_option("--ask", options->scene.kind, "result to compute: hit, count or clearance")
        .one_of({"hit", "count", "clearance"})
        .shows_default();
    command
        .add_option("--margin", options->scene.margin_mm,
                    "with hit or count: distance threshold, mm")
        .between(0.0, kMarginMmMax)
        .shows_default();
    command.add_option("--within", options->scene.within_mm, "largest clearance to measure, mm")
        .between(1e-6, kMarginMmMax)
        .shows_default();
    command.add_option("--queries", options->scene.queries,
                       "queries per cycle [default: all pairs of a pose]");
    const Option cycles =
        command
            .add_option("--cycles", options->scene.cycles,
                        "cycles to measure, after 50 warm-up cycles; with --paper: certified "
                        "launches of all triangle pairs of a pose")
            .between(1U, 100'000'000U);
    command.add_flag("--paper", options->paper,
                     "measure the tables of the seed paper on CPU and GPU, and each technique");
    add_worst_case_options(command, *options);
    command.add_option("--poses", options->experiment.poses, "number of random poses")
        .between(1U, kPosesMax)
        .shows_default();
    command.add_option("--seed", options->experiment.seed, "seed of the random poses")
        .shows_default();
    const Option passes =
        command
            .add_option("--passes", options->experiment.passes,
                        "report the best time of N passes [default: 3, with --pose 25]")
            .between(1U, 1000U);
    command
        .add_option("--engine", options->engine, "cpu, cuda (GPU) or auto (CUDA if there is a GPU)")
        .one_of({"cpu", "cuda", "auto"});
    command.add_option("--sms", options->experiment.multiprocessors,
                       "run on N GPU multiprocessors [default: 0 = all]");
    command.add_option("--data", options->experiment.data,
                       "folder that contains config/machines/ [default: source tree]");
    add_json_option(command, options->json);
    command.set_action([options, cycles, passes] {
        options->has_cycles = cycles.is_given();
        options->experiment.cycles = cycles.is_given() ? options->scene.cycles : 0;
        if (passes.is_given()) {
            options->pose_passes = options->experiment.passes;
        }
        return benchmark(*options);
    });
}

}  // namespace axg
