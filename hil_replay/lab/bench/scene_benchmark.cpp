// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/scene_benchmark.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "core/machine/kinematics.hpp"
#include "cuda/bench/leaf_kernels.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "firmware_if/cli/command_files.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "hil_replay/lab/bench/bench_json.hpp"
#include "hil_replay/lab/bench/scene_folder.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

std::vector<Query> queries_of(const SceneFolder& scene, const SceneBenchmarkOptions& options) {
    std::vector<Query> queries;
    for (std::size_t pose = 0; pose < scene.poses.size(); ++pose) {
        for (const SceneFolder::Pair& pair : scene.pairs) {
            Query q;
            q.kind = options.kind == "hit"     ? QueryKind::farther
                     : options.kind == "count" ? QueryKind::touching
                                               : QueryKind::clearance;
            q.r_mm = q.kind == QueryKind::clearance ? options.within_mm : options.margin_mm;
            q.pose_error_mm = scene.pose_error_mm;
            q.mesh_a = static_cast<std::uint32_t>(pair.a);
            q.mesh_b = static_cast<std::uint32_t>(pair.b);
            q.pose = relative_pose(scene.at(pose, pair.a), scene.at(pose, pair.b));
            queries.push_back(q);
        }
    }
    return queries;
}

/// Runs cycle after cycle, unpaced. Each time covers exactly one call of the engine.
void run_cycles(const Engine& engine, const std::vector<Query>& queries,
                const SceneBenchmarkOptions& options, SceneMeasurement& out) {
    using Clock = std::chrono::steady_clock;
    constexpr std::uint32_t kWarmUp = 50;
    const std::size_t places = queries.size() / out.per_cycle;
    std::vector<QueryResult> results(out.per_cycle);
    out.cycle_us.reserve(options.cycles);
    for (std::uint32_t i = 0; i < options.cycles + kWarmUp; ++i) {
        const std::span<const Query> cycle(queries.data() + i % places * out.per_cycle,
                                           out.per_cycle);
        const Clock::time_point start = Clock::now();
        engine(cycle, results);
        const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
        if (i >= kWarmUp) {
            out.cycle_us.push_back(spent.count());
            for (const QueryResult& result : results) {
                out.far += result.proof == Proof::far ? 1 : 0;
                out.not_ok += result.status == QueryStatus::ok ? 0 : 1;
            }
        }
    }
}

int measure_cpu(std::span<const Mesh* const> meshes, const std::vector<Query>& queries,
                const SceneBenchmarkOptions& options, SceneMeasurement& out) {
    std::optional<CpuEngine> engine = CpuEngine::create(meshes, Capacities{});
    if (!engine) {
        fmt::print(stderr, "axguard-lab bench: {}\n", kNoLaneSet);
        return kExitUnfit;
    }
    out.lanes = engine->lanes();
    run_cycles(engine->engine(), queries, options, out);
    return kExitClean;
}

int measure_cuda(std::span<const Mesh* const> meshes, const std::vector<Query>& queries,
                 const SceneBenchmarkOptions& options, SceneMeasurement& out) {
    CudaOptions cuda;
    cuda.multiprocessors = options.sms;
    cuda.queries_max = static_cast<std::uint32_t>(out.per_cycle);
    for (const LeafKernel& kernel : leaf_kernels()) {
        if (options.axis_data == kernel.name) {
            cuda.launch_leaves = kernel.launch;
        }
    }
    std::string fault;
    std::optional<CudaEngine> engine = CudaEngine::create(meshes, Capacities{}, cuda, fault);
    if (!engine) {
        fmt::print(stderr, "axguard-lab bench: {}\n", fault);
        return kExitGpu;
    }
    out.device = engine->device();
    out.memory = engine->memory();
    run_cycles(engine->engine(), queries, options, out);
    if (engine->fault() != nullptr) {
        fmt::print(stderr, "axguard-lab bench: {}\n", engine->fault());
        return kExitGpu;
    }
    return kExitClean;
}

void print(const SceneMeasurement& m, const SceneBenchmarkOptions& options) {
    const CyclePercentiles us = percentiles_of(m.cycle_us);
    fmt::print(options.json.words(),
               "{}, {} queries per cycle ({}): p50 {:.2f} us, p99 {:.2f}, p99.9 {:.2f}, max "
               "{:.2f}; {} cycles, 3/N {:.1e}\n",
               m.device ? "cuda" : "cpu", m.per_cycle, options.kind, us.p50_us, us.p99_us,
               us.p999_us, us.max_us, m.cycle_us.size(), us.three_over_n);
    if (m.device) {
        fmt::print(options.json.words(), "{}, {} of {} multiprocessors at up to {} MHz\n",
                   m.device->name, m.device->multiprocessors_used, m.device->multiprocessors,
                   m.device->clock_khz / 1000);
    }
}

}  // namespace

int run_scene_benchmark(const SceneBenchmarkOptions& options) {
    SceneFolder scene;
    if (const std::string fault = read_scene_folder(options.folder, scene); !fault.empty()) {
        fmt::print(stderr, "{}\n", fault);
        return kExitInput;
    }
    if (options.json.files && !are_apart(*options.json.files, scene.files, stderr)) {
        return kExitUsage;
    }
    std::vector<const Mesh*> meshes;
    for (const Mesh& mesh : scene.bodies) {
        meshes.push_back(&mesh);
    }
    const std::vector<Query> queries = queries_of(scene, options);
    SceneMeasurement measured;
    measured.per_cycle = options.queries == 0 ? scene.pairs.size() : options.queries;
    if (measured.per_cycle == 0 || queries.size() < measured.per_cycle) {
        fmt::print(stderr,
                   "{}: too few queries (found {} poses times pairs, expected at least {} for a "
                   "cycle). State fewer with --queries.\n",
                   options.folder, queries.size(), measured.per_cycle);
        return kExitInput;
    }
    const int code = options.engine != "cuda" ? measure_cpu(meshes, queries, options, measured)
                                              : measure_cuda(meshes, queries, options, measured);
    if (code != kExitClean) {
        return code;
    }
    print(measured, options);
    return write_json(options.json, describe_scene(measured, options.kind)) ? kExitClean
                                                                            : kExitInternal;
}

}  // namespace axg
