// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/worst_case_benchmark.hpp"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/lab/bench/bench_json.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

void print(const WorstCaseMeasurement& m, const BatchCapacities& batch, std::FILE* to) {
    fmt::print(to,
               "{}, {} of {} multiprocessors; {} queries in {} launches, {} levels\nlists of a "
               "batch: {} node pairs per level, {} leaf pairs, {} box rows, {} triangle pairs, {} "
               "rechecks\n\n{:<12} {:<14} {:>9} {:>9} {:>9} {:>9} {:>9}\n",
               m.device.name, m.device.multiprocessors_used, m.device.multiprocessors,
               m.cycle.queries, m.cycle.launches, m.cycle.tree_levels, batch.level_pairs,
               batch.leaf_pairs, batch.box_rows, batch.triangle_pairs, batch.rechecks, "layout",
               "beside it", "p50 us", "p99", "p99.9", "max", "3/N");
    for (const WorstCaseMeasurement::Line& line : m.lines) {
        const CyclePercentiles us = percentiles_of(line.cycle_us);
        fmt::print(to, "{:<12} {:<14} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1e}\n", line.layout,
                   line.condition, us.p50_us, us.p99_us, us.p999_us, us.max_us, us.three_over_n);
    }
    fmt::print(to, "slowest of all: {:.1f} us\n", m.us_max);
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
    print(*measured, capacities.batch, options.json.words());
    return write_json(options.json, describe_worst_case(*measured, capacities.batch))
               ? kExitClean
               : kExitInternal;
}

}  // namespace axg
