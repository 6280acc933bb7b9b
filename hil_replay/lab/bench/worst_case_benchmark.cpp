// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/worst_case_benchmark.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

nlohmann::ordered_json describe_line(const WorstCaseMeasurement::Line& line) {
    return {{"layout", line.layout},
            {"condition", line.condition},
            {"split", line.split},
            {"cycles", line.cycle_us.size()},
            {"cycle_us", describe_cycles(line.cycle_us)}};
}

nlohmann::ordered_json describe(const WorstCaseMeasurement& m, const Capacities& capacities) {
    nlohmann::ordered_json document{{"bench", "fill"},
                                    {"questions", m.cycle.queries},
                                    {"levels", m.cycle.tree_levels},
                                    {"launches", m.cycle.launches},
                                    {"us_max", m.us_max}};
    const BatchCapacities& batch = capacities.batch;
    document["capacities"] = {{"level_pairs", batch.level_pairs},
                              {"leaf_pairs", batch.leaf_pairs},
                              {"box_rows", batch.box_rows},
                              {"triangle_pairs", batch.triangle_pairs},
                              {"rechecks", batch.rechecks}};
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

void print(const nlohmann::ordered_json& d, std::FILE* to) {
    const auto& capacities = d["capacities"];
    fmt::print(to,
               "{}, {} of {} multiprocessors; {} questions in {} launches, {} levels\n"
               "lists of a batch: {} pairs of nodes a level, {} pairs of leaves, {} rows of boxes, "
               "{} pairs of triangles, {} rechecks\n\n"
               "{:<12} {:<14} {:<10} {:>9} {:>9} {:>9} {:>9} {:>9}\n",
               d["device"]["name"].get<std::string>(),
               d["device"]["multiprocessors_used"].get<unsigned>(),
               d["device"]["multiprocessors"].get<unsigned>(), d["questions"].get<unsigned>(),
               d["launches"].get<unsigned>(), d["levels"].get<unsigned>(),
               capacities["level_pairs"].get<unsigned>(), capacities["leaf_pairs"].get<unsigned>(),
               capacities["box_rows"].get<unsigned>(), capacities["triangle_pairs"].get<unsigned>(),
               capacities["rechecks"].get<unsigned>(), "layout", "beside it", "split", "p50 us",
               "p99", "p99.9", "max", "3/N");
    for (const auto& line : d["lines"]) {
        const auto& us = line["cycle_us"];
        fmt::print(to, "{:<12} {:<14} {:<10} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1e}\n",
                   line["layout"].get<std::string>(), line["condition"].get<std::string>(),
                   line["split"].get<std::string>(), us["p50"].get<double>(),
                   us["p99"].get<double>(), us["p999"].get<double>(), us["max"].get<double>(),
                   us["three_over_n"].get<double>());
    }
    fmt::print(to, "slowest of all: {:.1f} us\n", d["us_max"].get<double>());
}

}  // namespace

int run_worst_case_benchmark(const WorstCaseBenchmarkOptions& options) {
    Capacities capacities;
    std::uint32_t tree_levels = 2;
    if (!options.machine.empty()) {
        LoadedMachine loaded;
        if (!load(options.machine, "", loaded, stderr)) {
            return kExitInput;
        }
        capacities = loaded.machine.capacities;
        tree_levels = tree_levels_of(loaded);
    }
    tree_levels = options.tree_levels != 0 ? options.tree_levels : tree_levels;
    std::string fault;
    CudaOptions cuda;
    cuda.multiprocessors = options.sms;
    WorstCaseCycle cycle;
    cycle.tree_levels = tree_levels;
    cycle.launches = options.launches;
    cycle.count = options.cycles;
    const std::optional<WorstCaseMeasurement> measured =
        measure_worst_case(capacities, cuda, cycle, fault);
    if (!measured) {
        fmt::print(stderr, "axguard-lab bench: {}\n", fault);
        return kExitGpu;
    }
    const nlohmann::ordered_json document = describe(*measured, capacities);
    print(document, options.json.words());
    return write_json(options.json, document) ? kExitClean : kExitInternal;
}

}  // namespace axg
