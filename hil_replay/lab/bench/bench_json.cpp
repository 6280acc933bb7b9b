// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/bench_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "firmware_if/cli/document_json.hpp"
#include "hil_replay/lab/bench/paper_sums.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const CyclePercentiles& us) {
    return {{"p50", us.p50_us},
            {"p99", us.p99_us},
            {"p999", us.p999_us},
            {"max", us.max_us},
            {"three_over_n", us.three_over_n}};
}

Json describe_line(const WorstCaseMeasurement::Line& line) {
    return {{"layout", line.layout},
            {"condition", line.condition},
            {"cycles", line.cycle_us.size()},
            {"cycle_us", json_of(percentiles_of(line.cycle_us))}};
}

Json json_of(const WorkLists& lists) {
    Json out;
    for (const WorkListName& one : kWorkLists) {
        out[one.name] = lists.*one.list;
    }
    return out;
}

Json describe_call(const WorstCaseCall& call) {
    const BatchCapacities& batch = call.capacities.batch;
    Json out{{"times", call.times}, {"queries", call.queries}, {"is_stage", call.is_stage}};
    out["lists"] = {{call.is_stage ? "node_pairs" : "level_pairs", batch.level_pairs},
                    {"leaf_pairs", batch.leaf_pairs},
                    {"box_rows", batch.box_rows},
                    {"triangle_pairs", batch.triangle_pairs},
                    {"rechecks", batch.rechecks}};
    return out;
}

Json describe_measurement(const NamedMeasurement& named) {
    const WorstCaseMeasurement& m = named.measured;
    Json document{{"bench", "fill"},
                  {"axis_data", named.name},
                  {"levels", m.cycle.tree_levels},
                  {"launches", launches_of(m.cycle)},
                  {"us_max", m.us_max}};
    for (const WorstCaseCall& call : m.cycle.calls) {
        document["calls"].push_back(describe_call(call));
    }
    document["device"] = {{"name", m.device.name},
                          {"multiprocessors", m.device.multiprocessors},
                          {"multiprocessors_used", m.device.multiprocessors_used},
                          {"clock_mhz", m.device.clock_khz / 1000},
                          {"driver", m.device.driver},
                          {"runtime", m.device.runtime}};
    for (const WorstCaseMeasurement::Line& line : m.lines) {
        document["lines"].push_back(describe_line(line));
    }
    return document;
}

Json json_of(const CycleTime& time) {
    return {{"wall", time.wall_us}, {"thread", time.cpu_us}};
}

Json describe_line(const CycleLine& line) {
    Json out{{"layout", name_of(line.shape.layout)},
             {"open", line.shape.open},
             {"parts", line.shape.parts},
             {"caches", name_of(line.condition)},
             {"cycles", line.wall_us.size()},
             {"queries", queries_of(line.work)}};
    out["work"] = json_of(sum_of(line.work));
    out["least_of_five_us"] = json_of(line.least);
    out["cycle_us"] = json_of(percentiles_of(line.wall_us));
    return out;
}

Json json_of(const Spread& s) {
    return {{"avg_us", s.average}, {"min_us", s.least}, {"max_us", s.most}};
}

Json json_of(const PaperBenchmark& benchmark, const PaperSeries& series) {
    Json pairs = Json::object();
    for (std::size_t pair = 0; pair < benchmark.pairs.size(); ++pair) {
        pairs[benchmark.pairs[pair]] = json_of(of_pair(benchmark, series, pair));
    }
    const Differences naive = differences(series, benchmark.cpu[0]);
    const Differences engine = differences(series, benchmark.cpu[2]);
    return {{"name", series.name},
            {"pairs", std::move(pairs)},
            {"pose", json_of(of_pose(benchmark, series))},
            {"touching", hits_of(series)},
            {"tested_a_pose", per_pose(benchmark, series, &paper::Found::tested)},
            {"left_a_pose", per_pose(benchmark, series, &paper::Found::left)},
            {"hits_unlike_cpu_naive", naive.hits},
            {"counts_unlike_cpu_naive", naive.counts},
            {"hits_unlike_cpu_engine", engine.hits},
            {"counts_unlike_cpu_engine", engine.counts}};
}

Json json_of(const PaperRow& row) {
    return {{"cpu", json_of(row.cpu)}, {"gpu", json_of(row.gpu)}, {"speed_up", row.speed_up}};
}

Json seed_paper() {
    Json out{{"speed_up", kPaperSpeedUp}};
    for (const PaperRow& row : kPaperRows) {
        out["pairs"][std::string(row.pair)] = json_of(row);
    }
    return out;
}

}  // namespace

std::string describe_scene(const SceneMeasurement& m, const std::string& kind) {
    const CyclePercentiles us = percentiles_of(m.cycle_us);
    Json document{{"engine", m.device ? "cuda" : "cpu"},
                  {"ask", kind},
                  {"queries", m.per_cycle},
                  {"cycles", m.cycle_us.size()}};
    document["cycle_us"] = json_of(us);
    document["far"] = m.far;
    document["not_ok"] = m.not_ok;
    if (!m.lanes.empty()) {
        document["lanes"] = m.lanes;
    }
    if (m.device) {
        document["device"] = {{"name", m.device->name},
                              {"multiprocessors", m.device->multiprocessors},
                              {"multiprocessors_used", m.device->multiprocessors_used},
                              {"clock_mhz", m.device->clock_khz / 1000},
                              {"driver", m.device->driver},
                              {"runtime", m.device->runtime}};
        document["cycles_per_multiprocessor_p50"] =
            std::llround(us.p50_us * m.device->clock_khz / 1000.0);
        document["memory"] = {{"trees_bytes", m.memory.trees_bytes},
                              {"lists_bytes", m.memory.lists_bytes},
                              {"pinned_bytes", m.memory.pinned_bytes}};
    }
    return text_of(document);
}

std::string describe_poses(const PoseMeasurement& m, std::uint32_t passes) {
    return text_of(Json{{"bench", "pose"},
                        {"tasks", m.tasks},
                        {"queries", m.queries},
                        {"batches", m.batches},
                        {"passes", passes},
                        {"us", m.us}});
}

std::string describe_worst_case(const std::vector<NamedMeasurement>& all) {
    if (all.size() == 1) {
        return text_of(describe_measurement(all.front()));
    }
    Json document{{"bench", "fill"}, {"columns", Json::array()}};
    for (const NamedMeasurement& named : all) {
        document["columns"].push_back(describe_measurement(named));
    }
    return text_of(document);
}

std::string describe_offline(const OfflineMeasurement& m) {
    Json document{{"bench", "offline"},
                  {"device", m.device.name},
                  {"multiprocessors", m.device.multiprocessors},
                  {"device_bytes", m.memory.device_bytes()},
                  {"pinned_bytes", m.memory.pinned_bytes},
                  {"queries", m.queries},
                  {"far", m.far},
                  {"differ", m.differ},
                  {"again", m.again},
                  {"cpu_queries_s", m.cpu_queries_s},
                  {"cpu_pose_s", m.cpu_pose_s},
                  {"cycle_queries_s", m.cycle_queries_s}};
    for (const OfflineLine& line : m.lines) {
        const OfflineWork& w = line.work;
        document["lines"].push_back({{"queries", line.queries},
                                     {"batches", line.batches},
                                     {"is_posed", line.is_posed},
                                     {"queries_s", line.queries_s},
                                     {"device_queries_s", line.device_queries_s},
                                     {"p50_us", line.p50_us},
                                     {"p99_us", line.p99_us},
                                     {"batches_run", w.batches},
                                     {"to_device_s", w.to_device_s},
                                     {"pose_s", w.pose_s},
                                     {"answer_s", w.answer_s},
                                     {"to_host_s", w.to_host_s},
                                     {"fill_s", w.fill_s},
                                     {"launch_s", w.launch_s},
                                     {"wait_s", w.wait_s},
                                     {"check_s", w.check_s},
                                     {"again_s", w.again_s}});
    }
    return text_of(document);
}

std::string describe_cycles(const CycleMeasurement& m) {
    Json document{{"bench", "cycle"},
                  {"lanes", m.lanes},
                  {"tasks", m.tasks},
                  {"stages", m.plan.stages},
                  {"trees_bytes", m.memory_bytes},
                  {"longest_us", m.longest_us()}};
    document["posing_us"] = json_of(m.posing);
    for (std::uint32_t i = 0; i < m.plan.stages; ++i) {
        document["plan"].push_back(
            {{"queries", m.plan.queries[i]}, {"lists", json_of(m.plan.lists[i])}});
    }
    for (const CycleLine& line : m.lines) {
        document["lines"].push_back(describe_line(line));
    }
    return text_of(document);
}

std::string describe_paper_benchmark(const PaperBenchmark& benchmark) {
    Json out{{"bench", "paper"},
             {"poses", benchmark.pose_count()},
             {"seed", benchmark.options.seed},
             {"passes", benchmark.options.passes},
             {"lanes", benchmark.lanes},
             {"triangle_pairs", Json::object()},
             {"seed_paper", seed_paper()}};
    for (std::size_t pair = 0; pair < benchmark.pairs.size(); ++pair) {
        out["triangle_pairs"][benchmark.pairs[pair]] = benchmark.triangle_pairs[pair];
    }
    Json& methods = out["methods"] = Json::array();
    for (const PaperSeries* const series : all_series(benchmark)) {
        methods.push_back(json_of(benchmark, *series));
    }
    out["operating_range"] = {
        {"triangle_pairs", benchmark.within_travel.triangle_pairs},
        {"pose", json_of(of_pose(benchmark, benchmark.within_travel.cpu))},
        {"hits_unlike_cpu_naive", differences(benchmark.within_travel.cpu, benchmark.cpu[0]).hits}};
    if (benchmark.gpu.empty()) {
        out["no_gpu"] = benchmark.no_gpu;
        return text_of(out);
    }
    out["gpu"] = {{"name", benchmark.device.name},
                  {"multiprocessors", benchmark.device.multiprocessors},
                  {"multiprocessors_used", benchmark.device.multiprocessors_used},
                  {"driver", benchmark.device.driver},
                  {"runtime", benchmark.device.runtime}};
    Json& techniques = out["techniques"] = Json::array();
    for (const TechniqueSeries& line : benchmark.techniques) {
        techniques.push_back(json_of(benchmark, line.series));
        techniques.back()["name"] = name_of(line.techniques);
    }
    if (!benchmark.every_pair_us.empty()) {
        out["every_pair"] = {{"cycles", benchmark.every_pair_us.size()},
                             {"cycle_us", json_of(percentiles_of(benchmark.every_pair_us))}};
    }
    Json& kernels = out["kernels"] = Json::array();
    for (const paper::KernelFacts& kernel : benchmark.kernels) {
        kernels.push_back({{"name", kernel.name},
                           {"registers", kernel.registers},
                           {"shared_bytes", kernel.shared_bytes},
                           {"local_bytes", kernel.local_bytes}});
    }
    return text_of(out);
}

}  // namespace axg
