// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/offline_benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "core/certificate/pair_queries.hpp"
#include "core/certificate/posed_queries.hpp"
#include "core/collision/cpu_engine.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/surface_list.hpp"
#include "firmware_if/setup/travel_sample.hpp"
#include "hil_replay/lab/bench/bench_json.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kRepeated = 1U << 22U;  // queries of each batch under way

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The same queries twice: posed, and with the host's poses.
struct Scene {
    PosedPairs pairs;
    std::vector<double> positions;
    std::vector<PosedQuery> posed;
    std::vector<Query> given;
    std::vector<QueryResult> wanted;

    [[nodiscard]] PosedQueries batch() const { return {posed, positions}; }
};

/// All pairs at positions spread over the travel, posed by the host as in contact mode.
Scene make_scene(const Machine& machine, const OfflineBenchmarkOptions& options) {
    Scene scene;
    scene.pairs = posed_pairs_of(machine);
    const auto pair_queries = std::make_unique<PairQueries>();
    for (std::uint32_t row = 0; row < options.positions; ++row) {
        const AxisSnapshot snapshot = sampled_position(machine, row);
        make_contact_queries(machine, snapshot, *pair_queries);
        if (pair_queries->status != SnapshotStatus::ok) {
            continue;  // left_travel: a cycle would stop there
        }
        const auto rows = static_cast<std::uint32_t>(scene.positions.size() /
                                                     std::max<std::size_t>(machine.axes.size(), 1));
        scene.positions.insert(scene.positions.end(), snapshot.position.begin(),
                               snapshot.position.begin() + machine.axes.size());
        for (std::uint32_t i = 0; i < pair_queries->count; ++i) {
            Query query = pair_queries->queries[i];
            query.r_mm += options.margin_mm;
            scene.given.push_back(query);
            scene.posed.push_back({posed_pair(machine, pair_queries->pair[i], pair_queries->tool),
                                   rows, query.r_mm, query.pose_error_mm, query.is_float_only});
        }
    }
    return scene;
}

std::size_t count_differing(std::span<const QueryResult> x, std::span<const QueryResult> y) {
    std::size_t differ = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const bool are_far = x[i].proof == Proof::far;
        const bool same =
            x[i].proof == y[i].proof &&
            (!are_far ||
             (x[i].status == y[i].status && x[i].node_pairs == y[i].node_pairs &&
              x[i].triangle_pairs == y[i].triangle_pairs && x[i].rechecks == y[i].rechecks));
        differ += same ? 0 : 1;
    }
    return differ;
}

/// Times of single batches, spread over the scene.
void time_batches(OfflineEngine& engine, const Scene& scene, OfflineLine& line) {
    constexpr std::size_t kTimed = 400;
    const std::size_t count = std::min<std::size_t>(line.queries, scene.given.size());
    std::vector<QueryResult> results(count);
    std::vector<double> us;
    for (std::size_t i = 0; i < kTimed; ++i) {
        const std::size_t first = i * 7919 * count % (scene.given.size() - count + 1);
        const Clock::time_point start = Clock::now();
        if (line.is_posed) {
            engine.run(PosedQueries{std::span(scene.posed).subspan(first, count), scene.positions},
                       results);
        } else {
            engine.run(std::span(scene.given).subspan(first, count), results);
        }
        us.push_back(1e6 * seconds_since(start));
    }
    const CyclePercentiles all = percentiles_of(std::move(us));
    line.p50_us = all.p50_us;
    line.p99_us = all.p99_us;
}

/// The rate of the cycle's engine over the same queries; 0: it gave up.
double rate_of_cycles(std::span<const Mesh* const> meshes, const Machine& machine,
                      const Scene& scene) {
    std::string fault;
    std::optional<CudaEngine> engine = CudaEngine::create(
        meshes, machine.capacities, {.queries_max = 544, .deadline_us = 1'000'000}, fault);
    std::vector<QueryResult> results(scene.given.size());
    double least_s = std::numeric_limits<double>::infinity();
    for (int pass = 0; engine && pass < 3; ++pass) {
        const Clock::time_point start = Clock::now();
        engine->run(scene.given, results);
        least_s = std::min(least_s, seconds_since(start));
    }
    return engine && engine->fault() == nullptr ? static_cast<double>(scene.given.size()) / least_s
                                                : 0;
}

/// One line; empty after a fault.
std::optional<OfflineLine> measure_line(std::span<const Mesh* const> meshes,
                                        const Capacities& capacities, const Scene& scene,
                                        OfflineLine line, std::uint32_t passes,
                                        OfflineMeasurement& out, std::string& fault) {
    std::optional<OfflineEngine> engine = OfflineEngine::create(
        meshes, capacities, scene.pairs.chains, scene.pairs.pairs,
        {.queries_max = line.queries, .batches = line.batches, .measures = true}, fault);
    if (!engine) {
        return std::nullopt;
    }
    std::vector<QueryResult> results(scene.given.size());
    std::vector<double> each_s;
    for (std::uint32_t pass = 0; pass < passes && engine->fault() == nullptr; ++pass) {
        const Clock::time_point start = Clock::now();
        if (line.is_posed) {
            engine->run(scene.batch(), results);
        } else {
            engine->run(scene.given, results);
        }
        each_s.push_back(seconds_since(start));
    }
    if (engine->fault() != nullptr) {
        fault = engine->fault();
        return std::nullopt;
    }
    std::sort(each_s.begin(), each_s.end());
    const auto count = static_cast<double>(scene.given.size());
    line.work = engine->work();
    line.queries_s = count / each_s[each_s.size() / 2];
    if (line.batches == 1) {
        time_batches(*engine, scene, line);
    }
    line.device_queries_s = engine->repeat(std::max(1U, kRepeated / line.queries));
    out.differ += count_differing(scene.wanted, results);
    out.again = std::max(out.again, line.work.again / passes);
    out.device = engine->device();
    out.memory = engine->memory();
    return line;
}

void print_line(const OfflineLine& line, std::FILE* words) {
    const OfflineWork& w = line.work;
    const double each = 1e6 / static_cast<double>(std::max<std::uint64_t>(w.batches, 1));
    fmt::print(
        words,
        "{:>6} queries a batch, {} under way, {} poses: {:.3g} queries a second with the "
        "host's checks, {:.3g} on the device\n"
        "       us a batch: to the device {:.1f}, poses {:.1f}, answers {:.1f}, back {:.1f}; "
        "host: filling {:.1f}, launching {:.1f}, waiting {:.1f}, checking {:.1f}, again "
        "{:.1f} ({} queries)\n",
        line.queries, line.batches, line.is_posed ? "the device's" : "the host's", line.queries_s,
        line.device_queries_s, w.to_device_s * each, w.pose_s * each, w.answer_s * each,
        w.to_host_s * each, w.fill_s * each, w.launch_s * each, w.wait_s * each, w.check_s * each,
        w.again_s * each, w.again);
    if (line.p50_us != 0) {
        fmt::print(words, "       one batch alone, call to results: p50 {:.1f} us, p99 {:.1f}\n",
                   line.p50_us, line.p99_us);
    }
}

/// The CPU engine's results, and what one core does in a second.
bool ask_cpu(std::span<const Mesh* const> meshes, const Machine& machine, Scene& scene,
             OfflineMeasurement& out) {
    std::optional<CpuEngine> cpu = CpuEngine::create(meshes, machine.capacities);
    if (!cpu) {
        return false;
    }
    scene.wanted.resize(scene.given.size());
    Clock::time_point start = Clock::now();
    cpu->run(scene.given, scene.wanted);
    out.cpu_queries_s = static_cast<double>(scene.given.size()) / seconds_since(start);
    start = Clock::now();
    double sum = 0;  // so that no pose is optimised away
    for (const PosedQuery& posed : scene.posed) {
        Query query;
        const bool is_posed =
            fill_posed(scene.pairs.chains.joints.data(), scene.pairs.chains.chains.data(),
                       scene.pairs.pairs[posed.pair],
                       &scene.positions[std::size_t{posed.row} * machine.axes.size()], query);
        sum += is_posed ? query.pose.t[0] : 1;
    }
    out.cpu_pose_s =
        sum == 0.5 ? 0 : static_cast<double>(scene.posed.size()) / seconds_since(start);
    out.queries = scene.given.size();
    for (const QueryResult& result : scene.wanted) {
        out.far += result.proof == Proof::far ? 1 : 0;
    }
    return true;
}

}  // namespace

int run_offline_benchmark(const OfflineBenchmarkOptions& options) {
    LoadedMachine loaded;
    if (!load(options.machine, "", loaded, stderr)) {
        return kExitInput;
    }
    const std::vector<const Mesh*> meshes = surface_list(loaded).engines;
    OfflineMeasurement out;
    Scene scene = make_scene(loaded.machine, options);
    if (!ask_cpu(meshes, loaded.machine, scene, out)) {
        fmt::print(stderr, "axguard-lab bench: {}\n", kNoLaneSet);
        return kExitUnfit;
    }
    std::FILE* const words = options.json.words();
    for (const std::uint32_t queries : {512U, 2048U, 8192U, 32768U, kOfflineQueriesMax}) {
        for (const std::uint32_t batches : {1U, 2U, 4U}) {
            for (const bool is_posed : {true, false}) {
                if (!is_posed && (batches != 2 || queries < 8192)) {
                    continue;
                }
                std::string fault;
                const std::optional<OfflineLine> line = measure_line(
                    meshes, loaded.machine.capacities, scene,
                    {.queries = queries, .batches = batches, .is_posed = is_posed, .work = {}},
                    options.passes, out, fault);
                if (!line) {
                    fmt::print(stderr, "axguard-lab bench: {}\n", fault);
                    return kExitGpu;
                }
                if (out.lines.empty()) {
                    fmt::print(words, "{}, {} queries, {} of them far\n", out.device.name,
                               out.queries, out.far);
                }
                print_line(*line, words);
                out.lines.push_back(*line);
            }
        }
    }
    out.cycle_queries_s = rate_of_cycles(meshes, loaded.machine, scene);
    fmt::print(words, "the cycle's engine in launches of 544: {:.3g} queries a second\n",
               out.cycle_queries_s);
    fmt::print(words,
               "one core: {:.3g} queries a second, {:.3g} poses; {} of {} results of {} lines "
               "differ; {} queries a pass by the CPU engine\n",
               out.cpu_queries_s, out.cpu_pose_s, out.differ, out.queries * out.lines.size(),
               out.lines.size(), out.again);
    if (!write_json(options.json, describe_offline(out))) {
        return kExitInternal;
    }
    return out.differ == 0 ? kExitClean : kExitInternal;
}

}  // namespace axg
