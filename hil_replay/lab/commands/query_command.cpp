// SPDX-License-Identifier: Apache-2.0
// axguard-lab query: bare meshes at given poses, every pair of every pose, one line each. Judges
// surfaces; a body inside another counts as a hit.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "core/machine/kinematics.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "cuda/offline/offline_engine.hpp"
#include "firmware_if/cli/command_line.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/lab/bench/scene_folder.hpp"
#include "hil_replay/lab/commands/lab_commands.hpp"
#include "hil_replay/lab/commands/lab_commands_json.hpp"

namespace axg {
namespace {

struct QueryOptions {
    std::string folder, out, engine = "auto", kind = "clearance", lanes = "widest";
    double within_mm = 50.0;
    bool time = false;
    unsigned passes = 5;
    JsonOutput json;
};

struct Row {
    QueryResult result;
    double time_us = std::numeric_limits<double>::infinity();
};

QueryKind kind_of(const std::string& name) {
    return name == "hit"     ? QueryKind::farther
           : name == "count" ? QueryKind::touching
                             : QueryKind::clearance;
}

LaneSet lanes_of(const std::string& name) {
    return name == "avx512" ? LaneSet::avx512
           : name == "avx2" ? LaneSet::avx2
           : name == "neon" ? LaneSet::neon
                            : LaneSet::widest;
}

/// All that is the same in every query.
Query usual_query(const SceneFolder& scene, const QueryOptions& options) {
    Query query;
    query.kind = kind_of(options.kind);
    query.r_mm = query.kind == QueryKind::clearance ? options.within_mm : 0.0;
    query.pose_error_mm = scene.pose_error_mm;
    return query;
}

/// Queries every pair of every pose in batches without a limit, untimed. Sets `fault` if the GPU
/// failed.
std::vector<Row> run_offline(const SceneFolder& scene, std::span<const Mesh* const> meshes,
                             const Capacities& capacities, const QueryOptions& options,
                             std::string& runs_on, std::string& fault) {
    std::optional<OfflineEngine> engine =
        OfflineEngine::create(meshes, capacities, {}, {}, {}, fault);
    if (!engine) {
        return {};
    }
    runs_on = engine->device().name;
    std::vector<Query> queries(scene.poses.size() * scene.pairs.size(),
                               usual_query(scene, options));
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const SceneFolder::Pair& pair = scene.pairs[i % scene.pairs.size()];
        const std::size_t pose = i / scene.pairs.size();
        queries[i].mesh_a = static_cast<std::uint32_t>(pair.a);
        queries[i].mesh_b = static_cast<std::uint32_t>(pair.b);
        queries[i].pose = relative_pose(scene.at(pose, pair.a), scene.at(pose, pair.b));
    }
    std::vector<QueryResult> results(queries.size());
    engine->run(queries, results);
    fault = engine->fault() != nullptr ? engine->fault() : "";
    std::vector<Row> rows(results.size());
    std::transform(results.begin(), results.end(), rows.begin(),
                   [](const QueryResult& result) { return Row{result}; });
    return rows;
}

/// Queries every pair of every pose `passes` times; every pass gives the same results. Stores
/// the least times. Each time covers exactly one query: relative pose, query, result.
std::vector<Row> run_all(const SceneFolder& scene, const Engine& engine,
                         const QueryOptions& options, std::vector<double>& cycle_us) {
    using Clock = std::chrono::steady_clock;
    std::vector<Row> rows(scene.poses.size() * scene.pairs.size());
    cycle_us.assign(scene.poses.size(), std::numeric_limits<double>::infinity());
    Query query = usual_query(scene, options);
    for (unsigned pass = 0; pass < (options.time ? options.passes : 1U); ++pass) {
        for (std::size_t pose = 0; pose < scene.poses.size(); ++pose) {
            double cycle = 0;
            for (std::size_t pair = 0; pair < scene.pairs.size(); ++pair) {
                const SceneFolder::Pair& p = scene.pairs[pair];
                Row& row = rows[pose * scene.pairs.size() + pair];
                const Clock::time_point start = Clock::now();
                query.mesh_a = static_cast<std::uint32_t>(p.a);
                query.mesh_b = static_cast<std::uint32_t>(p.b);
                query.pose = relative_pose(scene.at(pose, p.a), scene.at(pose, p.b));
                engine({&query, 1}, {&row.result, 1});
                const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
                row.time_us = std::min(row.time_us, spent.count());
                cycle += spent.count();
            }
            cycle_us[pose] = std::min(cycle_us[pose], cycle);
        }
    }
    return rows;
}

/// For each row: whether the surfaces are proven apart, but one body is or may be inside the other.
/// Empty: memory ran out.
std::optional<std::vector<bool>> find_contained(const SceneFolder& scene, CpuEngine& engine,
                                                const std::vector<Row>& rows) {
    std::vector<const Mesh*> meshes;
    for (const Mesh& mesh : scene.bodies) {
        meshes.push_back(&mesh);
    }
    constexpr Capacities kCapacities;
    const std::optional<ContainmentTest> test =
        ContainmentTest::create(meshes, engine.trees(), kCapacities);
    if (!test) {
        return std::nullopt;
    }
    std::vector<bool> contained(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const SceneFolder::Pair& pair = scene.pairs[i % scene.pairs.size()];
        const std::size_t pose = i / scene.pairs.size();
        Query query;
        query.kind = QueryKind::farther;
        query.pose_error_mm = std::max(scene.pose_error_mm, kPlaceErrorMm);
        query.mesh_a = static_cast<std::uint32_t>(pair.a);
        query.mesh_b = static_cast<std::uint32_t>(pair.b);
        query.pose = relative_pose(scene.at(pose, pair.a), scene.at(pose, pair.b));
        QueryResult surfaces;
        ContainmentResult result;
        if (rows[i].result.proof == Proof::far) {
            engine.engine()({&query, 1}, {&surfaces, 1});
            test->run({&query, 1}, {&surfaces, 1}, {&result, 1});
            contained[i] = surfaces.proof == Proof::far && result.containment != Containment::none;
        }
    }
    return contained;
}

/// Rounded down to 1e-9 mm, so that the text never claims more than was proven.
std::string clearance_text(double clearance_mm) {
    return fmt::format("{:.9f}", std::floor(clearance_mm * 1e9) * 1e-9);
}

std::string table_text(const SceneFolder& scene, const std::vector<Row>& rows,
                       const std::vector<bool>& contained, const QueryOptions& options) {
    std::string text = options.time ? "pose,pair,hit,count,clearance_mm,time_us\n"
                                    : "pose,pair,hit,count,clearance_mm\n";
    const QueryKind kind = kind_of(options.kind);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const QueryResult& a = rows[i].result;
        const bool usable = a.status == QueryStatus::ok;
        text += fmt::format("{},{},{},", scene.poses[i / scene.pairs.size()],
                            scene.pairs[i % scene.pairs.size()].name,
                            a.proof == Proof::far && !contained[i] ? 0 : 1);
        if (kind == QueryKind::touching && usable) {
            text += fmt::format("{}", a.touching);
        }
        text += ',';
        if (kind == QueryKind::clearance && (!usable || a.clearance_mm < options.within_mm)) {
            text += clearance_text(usable ? a.clearance_mm : 0.0);
        }
        if (options.time) {
            text += fmt::format(",{:.3f}", rows[i].time_us);
        }
        text += '\n';
    }
    return text;
}

double at_share(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::ceil(share * last))];
}

QueryReport report_of(const SceneFolder& scene, const std::string& runs_on,
                      const std::vector<Row>& rows, const std::vector<bool>& contained,
                      const std::vector<double>& cycle_us, const QueryOptions& options) {
    QueryReport report{.poses = scene.poses.size(),
                       .pairs = scene.pairs.size(),
                       .engine = options.engine == "cuda" ? "cuda" : "cpu",
                       .lanes = runs_on,
                       .kind = options.kind};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        report.hits += rows[i].result.proof == Proof::far && !contained[i] ? 0 : 1;
        report.contained += contained[i] ? 1 : 0;
        report.over_capacity += rows[i].result.status == QueryStatus::ok ? 0 : 1;
    }
    if (options.time) {
        report.passes = options.passes;
        report.cycle_us_median = at_share(cycle_us, 0.5);
        report.cycle_us_p99 = at_share(cycle_us, 0.99);
        report.cycle_us_max = at_share(cycle_us, 1.0);
    }
    return report;
}

void print_report(const SceneFolder& scene, const std::string& runs_on, const QueryReport& report,
                  const QueryOptions& options) {
    fmt::print(options.json.words(), "{} poses, {} pairs, {}: {} not proven apart{}\n",
               report.poses, report.pairs, runs_on, report.hits,
               report.contained == 0
                   ? ""
                   : fmt::format(", {} of them with one body inside the other", report.contained));
    if (scene.pose_error_mm > 0) {
        fmt::print(options.json.words(),
                   "matrices are not exactly rigid: every result allows for {:.3g} mm\n",
                   scene.pose_error_mm);
    }
    if (options.time) {
        fmt::print(options.json.words(),
                   "us per cycle of {} pairs, minimum of {} passes: median {:.2f}, p99 {:.2f}, max "
                   "{:.2f}\n",
                   report.pairs, options.passes, report.cycle_us_median, report.cycle_us_p99,
                   report.cycle_us_max);
    }
}

int query_scene(const QueryOptions& options) {
    SceneFolder scene;
    if (const std::string fault = read_scene_folder(options.folder, scene); !fault.empty()) {
        fmt::print(stderr, "{}\n", fault);
        return kExitInput;
    }
    if (!are_apart(*options.json.files, scene.files, stderr)) {
        return kExitUsage;
    }
    std::vector<const Mesh*> meshes;
    for (const Mesh& mesh : scene.bodies) {
        meshes.push_back(&mesh);
    }
    const bool on_gpu = options.engine == "cuda";
    // Queries for contact without times run in large batches.
    const bool is_offline = on_gpu && options.kind == "hit" && !options.time;
    std::string fault = std::string(kNoLaneSet);
    constexpr Capacities kCapacities;
    // One query at a time leaves room for every pair of triangles that may set a clearance.
    std::optional<CudaEngine> gpu =
        on_gpu && !is_offline
            ? CudaEngine::create(meshes, kCapacities,
                                 {.queries_max = 1, .candidates = kCapacities.triangle_pairs},
                                 fault)
            : std::nullopt;
    // The containment test always needs the CPU engine.
    std::optional<CpuEngine> cpu = CpuEngine::create(meshes, kCapacities, lanes_of(options.lanes));
    if ((on_gpu && !is_offline && !gpu) || !cpu) {
        fmt::print(stderr, "axguard-lab query: {}\n", fault);
        return on_gpu && !is_offline && !gpu ? kExitGpu : kExitUnfit;
    }
    std::string runs_on = gpu ? gpu->device().name : std::string(cpu->lanes());
    std::vector<double> cycle_us;
    fault.clear();
    const std::vector<Row> rows =
        is_offline ? run_offline(scene, meshes, kCapacities, options, runs_on, fault)
                   : run_all(scene, gpu ? gpu->engine() : cpu->engine(), options, cycle_us);
    if (gpu && gpu->fault() != nullptr) {
        fault = gpu->fault();
    }
    if (!fault.empty()) {
        fmt::print(stderr, "axguard-lab query: {}\n", fault);
        return kExitGpu;
    }
    const std::optional<std::vector<bool>> contained = find_contained(scene, *cpu, rows);
    if (!contained) {
        fmt::print(stderr, "axguard-lab query: {}\n", kNoMemoryForContainment);
        return kExitUnfit;
    }
    if (!write_whole_file(options.out, table_text(scene, rows, *contained, options), stderr)) {
        return kExitInternal;
    }
    const QueryReport report = report_of(scene, runs_on, rows, *contained, cycle_us, options);
    print_report(scene, runs_on, report, options);
    return write_json(options.json, describe_queries(report)) ? kExitClean : kExitInternal;
}

}  // namespace

void add_query(CommandLine& line) {
    auto options = std::make_shared<QueryOptions>();
    const Command command =
        line.add_command("query", "Query meshes at given poses: contact, count or clearance");
    command.set_example("axguard-lab query scene/ --output answers.csv --ask clearance --time");
    command
        .add_option("SCENE_DIR", options->folder,
                    "folder with bodies.csv, pairs.csv, poses.csv and STL files")
        .required();
    command
        .add_output("-o,--output", options->out,
                    "CSV file to write: pose,pair,hit,count,clearance_mm")
        .required();
    command
        .add_option("--engine", options->engine, "cpu, cuda (GPU) or auto (CUDA if there is a GPU)")
        .one_of({"cpu", "cuda", "auto"});
    command
        .add_option("--lanes", options->lanes,
                    "lane set of the CPU engine: widest, avx512, avx2 or neon")
        .one_of({"widest", "avx512", "avx2", "neon"});
    command.add_option("--ask", options->kind, "result to compute: hit, count or clearance")
        .one_of({"hit", "count", "clearance"})
        .shows_default();
    command.add_option("--within", options->within_mm, "largest clearance to measure, mm")
        .between(1e-6, kMarginMmMax)
        .shows_default();
    command.add_flag("--time", options->time,
                     "add the column time_us and print the time per cycle");
    command.add_option("--passes", options->passes, "with --time: report the best time of N passes")
        .between(1U, 1000U)
        .shows_default();
    add_json_option(command, options->json);
    command.set_action([options] { return query_scene(*options); });
}

}  // namespace axg
