// SPDX-License-Identifier: Apache-2.0
// axguard-lab bench: measures this machine. Ends with 0 whatever it finds.
#include <fmt/format.h>

#include <memory>

#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/cycle_work.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "hil_replay/lab/bench/cycle_benchmark.hpp"
#include "hil_replay/lab/bench/paper_benchmark.hpp"
#include "hil_replay/lab/bench/pose_benchmark.hpp"
#include "hil_replay/lab/bench/scene_benchmark.hpp"
#include "hil_replay/lab/bench/worst_case_benchmark.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPosesMax = 2000;  // a series of eight pairs has its own memory

struct BenchOptions {
    bool paper = false, worst_case = false;
    PaperBenchmarkOptions experiment;
    SceneBenchmarkOptions scene;
    std::string machine, pose_machine, lanes;
    std::uint32_t tree_levels = 0, launches = 1, pose_passes = 25, step = kPlanStepAsStated;
    bool has_cycles = false;
    std::string engine = "auto";
    JsonOutput json;
};

/// With --worst-case: of a machine's plan on this processor, or of a GPU's batch.
int run_worst_case(const BenchOptions& options) {
    if (options.engine != "cpu") {
        return run_worst_case_benchmark({.machine = options.machine,
                                         .tree_levels = options.tree_levels,
                                         .launches = options.launches,
                                         .sms = options.experiment.multiprocessors,
                                         .cycles = options.scene.cycles,
                                         .json = options.json});
    }
    const std::string usual = options.experiment.data + "/config/machines/paper-trunnion.yaml";
    return run_cycle_benchmark({.machine = options.machine.empty() ? usual : options.machine,
                                .lanes = options.lanes,
                                .cycles = options.has_cycles ? options.scene.cycles : 0,
                                .step = options.step,
                                .json = options.json});
}

int benchmark(const BenchOptions& options) {
    const int wanted = (options.paper ? 1 : 0) + (options.worst_case ? 1 : 0) +
                       (options.scene.folder.empty() ? 0 : 1) +
                       (options.pose_machine.empty() ? 0 : 1);
    if (wanted != 1) {
        fmt::print(
            stderr,
            "axguard-lab bench: wanted one thing to measure: SCENE_DIR, --paper, --worst-case or "
            "--pose\n");
        return kExitUsage;
    }
    if (!options.pose_machine.empty()) {
        return run_pose_benchmark(
            {.machine = options.pose_machine, .passes = options.pose_passes, .json = options.json});
    }
    if (options.worst_case) {
        return run_worst_case(options);
    }
    if (!options.paper) {
        SceneBenchmarkOptions scene = options.scene;
        scene.engine = options.engine;
        scene.sms = options.experiment.multiprocessors;
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

}  // namespace

void add_bench(CommandLine& line) {
    auto options = std::make_shared<BenchOptions>();
    options->experiment.data = AXG_DATA_DIR;
    const Command command = line.add_command("bench", "Measures this machine");
    command.set_example("axguard-lab bench --paper --poses 400");
    command.add_option("SCENE_DIR", options->scene.folder,
                       "times an engine over its poses: bodies.csv, pairs.csv, poses.csv, STLs");
    command.add_option("--ask", options->scene.kind, "hit, count or clearance")
        .one_of({"hit", "count", "clearance"});
    command.add_option("--margin", options->scene.margin_mm, "hit, count: closer than this, mm")
        .between(0.0, kMarginMmMax);
    command.add_option("--within", options->scene.within_mm, "clearances up to this, mm")
        .between(1e-6, kMarginMmMax);
    command.add_option("--questions", options->scene.queries,
                       "a cycle; the pairs of one pose unless stated");
    const Option cycles =
        command
            .add_option("--cycles", options->scene.cycles,
                        "how many, after 50 that do not count; with --paper: launches of every "
                        "pair of triangles of a pose, certified, for percentiles")
            .between(1U, 100'000'000U);
    command.add_flag("--paper", options->paper,
                     "the seed paper's tables, on CPU and GPU, and what each technique does");
    command.add_flag(
        "--worst-case,--fill", options->worst_case,
        "every list full: the longest batch of a GPU, or with --engine cpu the longest "
        "cycle of a machine's plan");
    command.add_input("--machine", options->machine,
                      "with --worst-case: its capacities, and the levels of its trees");
    command
        .add_option("--step", options->step,
                    "with --worst-case --engine cpu: which of the plans that a start chooses from; "
                    "2 is the machine file's")
        .between(0U, kPlanSteps - 1);
    command.add_option("--lanes", options->lanes, "with --worst-case --engine cpu")
        .one_of({"avx512", "avx2", "neon"});
    command.add_input("--pose", options->pose_machine,
                      "how long this machine's cycle takes to pose its boxes");
    command
        .add_option(
            "--levels", options->tree_levels,
            "with --worst-case: of pairs of nodes; those of the machine's trees unless stated")
        .between(1U, kTreeDepthMax);
    command
        .add_option("--launches", options->launches,
                    "with --worst-case: a cycle of so many launches, which share the lists")
        .between(1U, 64U);
    command.add_option("--poses", options->experiment.poses, "random poses").between(1U, kPosesMax);
    command.add_option("--seed", options->experiment.seed, "of the poses");
    const Option passes =
        command.add_option("--passes", options->experiment.passes, "the least of so many")
            .between(1U, 1000U);
    command.add_option("--engine", options->engine, "cpu, cuda or auto: a GPU where there is one")
        .one_of({"cpu", "cuda", "auto"});
    command.add_option("--sms", options->experiment.multiprocessors,
                       "a partition of so many multiprocessors of the GPU; 0: all");
    command.add_option("--data", options->experiment.data, "holds config/machines/");
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
