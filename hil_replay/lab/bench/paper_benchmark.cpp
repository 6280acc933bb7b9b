// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/paper_benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/sincos.hpp"
#include "core/certificate/pair_queries.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "cuda/paper/brute_cpu.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_proof.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

using Clock = std::chrono::steady_clock;
using paper::Found;
using paper::PairPose;
using paper::Techniques;
using paper::Timing;

constexpr std::uint32_t kPosesOfMotion = 10;
constexpr double kStepOfTravel = 1e-3;  // the longest step of an axis between two poses

/// The queries for every method, pose by pose.
struct Experiment {
    LoadedMachine loaded;
    paper::Scene scene;
    std::vector<Query> queries;   // [pose][pair] for the engine
    std::vector<PairPose> poses;  // the same for the paper's kernels
};

/// Random positions within travel, each with a short straight motion of all axes: consecutive
/// poses are close, as samples are, so that a method can carry an axis over.
std::vector<AxisSnapshot> random_snapshots(const Machine& machine, std::uint32_t count,
                                           std::uint64_t seed) {
    lab::Draw draw(seed);
    std::vector<AxisSnapshot> snapshots;
    std::vector<double> step(machine.axes.size());
    AxisSnapshot snapshot;
    snapshot.axis_count = static_cast<std::uint32_t>(machine.axes.size());
    while (snapshots.size() < count) {
        const bool is_start = snapshots.size() % kPosesOfMotion == 0;
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            const Axis& axis = machine.axes[i];
            const double low = axis.unlimited ? -kPi : axis.min;
            const double high = axis.unlimited ? kPi : axis.max;
            if (is_start) {
                snapshot.position[i] = draw.between(low, high);
                step[i] = (high - low) * draw.between(-kStepOfTravel, kStepOfTravel);
            } else {
                snapshot.position[i] = std::clamp(snapshot.position[i] + step[i], low, high);
            }
        }
        snapshots.push_back(snapshot);
    }
    return snapshots;
}

/// The bodies of the machine's pairs, by the engine's mesh numbers.
void make_scene(Experiment& e, const PairQueries& pair_queries) {
    const std::vector<const Mesh*> surfaces = surface_list(e.loaded).engines;
    std::vector<std::uint32_t> body_of(surfaces.size(), kNoIndex);
    const auto body = [&](std::uint32_t mesh) {
        if (body_of[mesh] == kNoIndex) {
            body_of[mesh] = static_cast<std::uint32_t>(e.scene.bodies.size());
            e.scene.bodies.push_back(paper::make_body(surfaces[mesh]->triangles));
        }
        return body_of[mesh];
    };
    for (std::uint32_t i = 0; i < pair_queries.count; ++i) {
        const std::uint32_t a = body(pair_queries.queries[i].mesh_a);
        e.scene.pairs.push_back({a, body(pair_queries.queries[i].mesh_b)});
    }
}

int prepare(const PaperBenchmarkOptions& options, Experiment& e, std::FILE* messages) {
    const std::filesystem::path file =
        std::filesystem::path(options.data) / "config/machines/paper-trunnion.yaml";
    std::error_code code;
    if (!std::filesystem::exists(file, code)) {
        fmt::print(messages, "{}: not there; --data FOLDER names the folder that holds config/\n",
                   file.string());
        return kExitInput;
    }
    if (!load(file.string(), "", e.loaded, messages)) {
        return kExitInput;
    }
    const auto pair_queries = std::make_unique<PairQueries>();
    for (const AxisSnapshot& snapshot :
         random_snapshots(e.loaded.machine, options.poses, options.seed)) {
        make_contact_queries(e.loaded.machine, snapshot, *pair_queries);
        if (pair_queries->status != SnapshotStatus::ok) {
            fmt::print(messages, "axguard-lab bench: a pose was refused\n");
            return kExitInternal;
        }
        if (e.scene.pairs.empty()) {
            make_scene(e, *pair_queries);
        }
        for (std::uint32_t i = 0; i < pair_queries->count; ++i) {
            e.queries.push_back(pair_queries->queries[i]);
            e.queries.back().r_mm = 0;  // the paper tests for contact
            e.poses.push_back({i, pair_queries->queries[i].pose});
        }
    }
    return kExitClean;
}

/// Runs every query `passes` times and stores the least time of each. Each time covers exactly
/// one query.
template <class Run>
PaperSeries timed(std::string name, const Experiment& e, std::uint32_t passes, const Run& run) {
    PaperSeries series{std::move(name), {}, {}};
    series.us.assign(e.poses.size(), std::numeric_limits<double>::infinity());
    series.found.resize(e.poses.size());
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        for (std::size_t i = 0; i < e.poses.size(); ++i) {
            const Clock::time_point start = Clock::now();
            series.found[i] = run(i);
            const std::chrono::duration<double, std::micro> spent = Clock::now() - start;
            series.us[i] = std::min(series.us[i], spent.count());
        }
    }
    return series;
}

/// Timed queries of the engines return no counts; this queries the counts afterwards.
void count_touching(const Experiment& e, const Engine& engine, PaperSeries& series) {
    for (std::size_t i = 0; i < e.queries.size(); ++i) {
        Query query = e.queries[i];
        query.kind = QueryKind::touching;
        QueryResult result;
        engine({&query, 1}, {&result, 1});
        series.found[i].touching = result.touching;
    }
}

Found found_of(const QueryResult& result) {
    return {result.proof == Proof::far ? 0U : 1U, result.triangle_pairs, result.rechecks};
}

PaperSeries timed_engine(const Experiment& e, std::uint32_t passes, CpuEngine& engine) {
    PaperSeries series = timed("CPU engine", e, passes, [&](std::size_t i) {
        QueryResult result;
        engine.run({&e.queries[i], 1}, {&result, 1});
        return found_of(result);
    });
    count_touching(e, engine.engine(), series);
    return series;
}

int run_cpu(const Experiment& e, PaperBenchmark& out, std::FILE* messages) {
    std::optional<CpuEngine> engine = make_engine(e.loaded);
    const LaneKernels* const lanes = lane_kernels(LaneSet::widest);
    if (!engine || lanes == nullptr) {
        fmt::print(messages, "axguard-lab bench: {}\n", kNoLaneSet);
        return kExitUnfit;
    }
    out.lanes = engine->lanes();
    const auto body_a = [&e](std::size_t i) -> const paper::Body& {
        return e.scene.bodies[e.scene.pairs[e.poses[i].pair].a];
    };
    const auto body_b = [&e](std::size_t i) -> const paper::Body& {
        return e.scene.bodies[e.scene.pairs[e.poses[i].pair].b];
    };
    const std::uint32_t passes = out.options.passes;
    out.cpu.push_back(timed("CPU naive", e, passes, [&](std::size_t i) {
        return paper::test_naively(body_a(i), body_b(i), e.poses[i].pose);
    }));
    out.cpu.push_back(timed("CPU certified", e, passes, [&](std::size_t i) {
        return paper::test_certified(*lanes, body_a(i), body_b(i), e.poses[i].pose);
    }));
    out.cpu.push_back(timed_engine(e, passes, *engine));
    return kExitClean;
}

/// The surfaces of each pair without the triangles that can never touch.
std::vector<std::array<paper::Body, 2>> bodies_within_travel(
    const Experiment& e, const std::vector<KeptTriangles>& kept) {
    std::vector<std::array<paper::Body, 2>> out(e.scene.pairs.size());
    const auto left_of = [](const paper::Body& whole, const Mesh& mesh,
                            const std::vector<std::uint32_t>& indices) {
        if (indices.size() == mesh.triangles.size()) {
            return whole;
        }
        std::vector<Triangle> triangles;
        for (const std::uint32_t index : indices) {
            triangles.push_back(mesh.triangles[index]);
        }
        return triangles.empty() ? paper::Body{} : paper::make_body(triangles);
    };
    const std::vector<const Mesh*> surfaces = surface_list(e.loaded).engines;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const auto of_pair = std::find_if(kept.begin(), kept.end(), [i](const KeptTriangles& k) {
            return k.pair == i && !k.is_apart;
        });
        if (of_pair != kept.end()) {
            const Query& query = e.queries[i];
            out[i] = {
                left_of(e.scene.bodies[e.scene.pairs[i].a], *surfaces[query.mesh_a], of_pair->a),
                left_of(e.scene.bodies[e.scene.pairs[i].b], *surfaces[query.mesh_b], of_pair->b)};
        }
    }
    return out;
}

int run_within_travel(const Experiment& e, PaperBenchmark& out, std::FILE* messages) {
    const std::optional<std::vector<KeptTriangles>> kept = prove_travel(e.loaded);
    if (!kept) {
        fmt::print(messages, "axguard-lab bench: {}\n", kNoLaneSet);
        return kExitUnfit;
    }
    const auto bodies = bodies_within_travel(e, *kept);
    for (const std::array<paper::Body, 2>& pair : bodies) {
        out.within_travel.triangle_pairs +=
            std::uint64_t{pair[0].triangles.size()} * pair[1].triangles.size();
    }
    out.within_travel.cpu =
        timed("CPU naive, operating range", e, out.options.passes, [&](std::size_t i) {
            const std::array<paper::Body, 2>& pair = bodies[e.poses[i].pair];
            return paper::test_naively(pair[0], pair[1], e.poses[i].pose);
        });
    return kExitClean;
}

/// Runs a series on the GPU `passes` times and stores the least time of each query. An untimed pass
/// comes first, because the first run of a kernel loads it.
template <class Run>
bool keep_least(PaperSeries& series, std::uint32_t passes, const Run& run) {
    std::vector<double> us(series.us.size());
    if (!run(series.found, us)) {
        return false;
    }
    std::fill(series.us.begin(), series.us.end(), std::numeric_limits<double>::infinity());
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        if (!run(series.found, us)) {
            return false;
        }
        for (std::size_t i = 0; i < us.size(); ++i) {
            series.us[i] = std::min(series.us[i], us[i]);
        }
    }
    return true;
}

PaperSeries empty_series(std::string name, const Experiment& e) {
    return {std::move(name), std::vector<double>(e.poses.size()),
            std::vector<Found>(e.poses.size())};
}

bool run_paper(paper::Gpu& gpu, const Experiment& e, const Techniques& techniques, Timing timing,
               std::uint32_t together, std::uint32_t passes, PaperSeries& series) {
    return keep_least(series, passes, [&](std::span<Found> found, std::span<double> us) {
        return gpu.run_paper(techniques, timing, together, e.poses, found, us);
    });
}

bool run_certified(paper::Gpu& gpu, const Experiment& e, Timing timing, std::uint32_t together,
                   std::uint32_t passes, PaperSeries& series) {
    return keep_least(series, passes, [&](std::span<Found> found, std::span<double> us) {
        return gpu.run_certified(timing, together, e.poses, found, us);
    });
}

/// No technique, coalesced only, each of the five alone, all but one of them, all five.
std::vector<Techniques> technique_choices() {
    bool Techniques::*const kEach[] = {&Techniques::boxes, &Techniques::interchange,
                                       &Techniques::unroll, &Techniques::prefetch,
                                       &Techniques::carry};
    std::vector<Techniques> choices{paper::kNoTechnique, paper::kNoTechnique};
    choices.back().coalesced = true;
    for (bool Techniques::*const one : kEach) {
        choices.push_back(paper::kNoTechnique);
        choices.back().*one = true;
    }
    for (bool Techniques::*const one : kEach) {
        choices.push_back(paper::kAllTechniques);
        choices.back().*one = false;
    }
    choices.push_back(paper::kAllTechniques);
    return choices;
}

bool run_gpu(const Experiment& e, paper::Gpu& gpu, PaperBenchmark& out) {
    const std::uint32_t passes = out.options.passes;
    const auto pair_count = static_cast<std::uint32_t>(e.scene.pairs.size());
    out.device = gpu.device();
    out.kernels = gpu.kernels();
    for (const char* const name : {"GPU naive", "GPU techniques", "GPU certified"}) {
        out.gpu.push_back(empty_series(name, e));
    }
    for (const char* const name : {"GPU certified, 8 a launch", "the same, on the device"}) {
        out.together.push_back(empty_series(name, e));
    }
    bool good = run_paper(gpu, e, paper::kNoTechnique, Timing::each, 1, passes, out.gpu[0]) &&
                run_paper(gpu, e, paper::kAllTechniques, Timing::each, 1, passes, out.gpu[1]) &&
                run_certified(gpu, e, Timing::each, 1, passes, out.gpu[2]) &&
                run_certified(gpu, e, Timing::each, pair_count, passes, out.together[0]) &&
                run_certified(gpu, e, Timing::queued, pair_count, passes, out.together[1]);
    for (const Techniques& techniques : technique_choices()) {
        TechniqueSeries& line =
            out.techniques.emplace_back(TechniqueSeries{techniques, empty_series("", e)});
        good =
            good && run_paper(gpu, e, techniques, Timing::queued, pair_count, passes, line.series);
    }
    return good;
}

/// Times the certified test of every triangle pair of a pose, with launch and return. Stores the
/// time of each pose.
bool time_every_pair(const Experiment& e, paper::Gpu& gpu, PaperBenchmark& out) {
    const auto pair_count = static_cast<std::uint32_t>(e.scene.pairs.size());
    std::vector<Found> found(e.poses.size());
    std::vector<double> us(e.poses.size());
    out.every_pair_us.reserve(out.options.cycles);
    while (out.every_pair_us.size() < out.options.cycles) {
        if (!gpu.run_certified(Timing::each, pair_count, e.poses, found, us)) {
            return false;
        }
        for (std::size_t i = 0; i < us.size() && out.every_pair_us.size() < out.options.cycles;
             i += pair_count) {
            out.every_pair_us.push_back(us[i]);
        }
    }
    return true;
}

/// The CUDA engine of replay and query, the pairs of a pose in one batch.
bool run_cuda_engine(const Experiment& e, PaperBenchmark& out, std::string& fault) {
    const std::vector<const Mesh*> meshes = surface_list(e.loaded).engines;
    const std::size_t pair_count = e.scene.pairs.size();
    CudaOptions options;
    options.multiprocessors = out.options.multiprocessors;
    options.queries_max = static_cast<std::uint32_t>(pair_count);
    std::optional<CudaEngine> engine =
        CudaEngine::create(meshes, e.loaded.machine.capacities, options, fault);
    if (!engine) {
        return false;
    }
    const std::span<const Query> queries(e.queries);
    std::vector<QueryResult> results(pair_count);
    PaperSeries& series = out.together.emplace_back(empty_series("CUDA engine, 8 a batch", e));
    const auto run = [&](std::span<Found> found, std::span<double> us) {
        for (std::size_t i = 0; i < found.size(); i += pair_count) {
            const Clock::time_point start = Clock::now();
            engine->run(queries.subspan(i, pair_count), results);
            us[i] = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
            std::transform(results.begin(), results.end(), found.begin() + std::ptrdiff_t(i),
                           found_of);
        }
        return engine->fault() == nullptr;
    };
    if (keep_least(series, out.options.passes, run)) {
        count_touching(e, engine->engine(), series);
    }
    fault = engine->fault() == nullptr ? "" : engine->fault();
    return fault.empty();
}

}  // namespace

Differences differences(const PaperSeries& a, const PaperSeries& b) {
    Differences out;
    for (std::size_t i = 0; i < a.found.size(); ++i) {
        const std::uint32_t x = a.found[i].touching, y = b.found[i].touching;
        out.hits += (x == 0) != (y == 0) ? 1 : 0;
        out.counts += x != y ? 1 : 0;
    }
    return out;
}

int run_paper_benchmark(const PaperBenchmarkOptions& options, PaperBenchmark& out,
                        std::FILE* messages) {
    Experiment e;
    out.options = options;
    if (const int code = prepare(options, e, messages); code != kExitClean) {
        return code;
    }
    for (std::size_t i = 0; i < e.scene.pairs.size(); ++i) {
        out.pairs.push_back(pair_name(e.loaded.machine, static_cast<std::uint32_t>(i)));
        out.triangle_pairs.push_back(e.scene.triangle_pairs(i));
    }
    if (const int code = run_cpu(e, out, messages); code != kExitClean) {
        return code;
    }
    if (const int code = run_within_travel(e, out, messages); code != kExitClean) {
        return code;
    }
    if (!options.use_gpu) {
        out.no_gpu = "not asked for";
        return kExitClean;
    }
    std::optional<paper::Gpu> gpu =
        paper::Gpu::create(e.scene, options.multiprocessors, out.no_gpu);
    if (!gpu) {
        return kExitClean;
    }
    std::string fault;
    if (!run_gpu(e, *gpu, out) || !time_every_pair(e, *gpu, out)) {
        fault = gpu->fault();
    } else if (run_cuda_engine(e, out, fault)) {
        return kExitClean;
    }
    fmt::print(messages, "axguard-lab bench: the GPU failed: {}\n", fault);
    return kExitGpu;
}

}  // namespace axg
