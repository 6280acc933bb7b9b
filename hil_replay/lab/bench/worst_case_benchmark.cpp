// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/worst_case_benchmark.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cuda/bench/leaf_kernels.hpp"
#include "cuda/bench/measure_worst_case.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/longest_gpu_cycle.hpp"
#include "hil_replay/lab/bench/bench_json.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

void print_calls(const WorstCaseCycle& cycle, std::FILE* to) {
    for (const WorstCaseCall& call : cycle.calls) {
        const BatchCapacities& batch = call.capacities.batch;
        fmt::print(to,
                   "{} x {} queries{}; lists: {} node pairs{}, {} leaf pairs, {} box rows, {} "
                   "triangle pairs, {} rechecks\n",
                   call.times, call.queries, call.is_stage ? " of a stage" : "", batch.level_pairs,
                   call.is_stage ? "" : " per level", batch.leaf_pairs, batch.box_rows,
                   batch.triangle_pairs, batch.rechecks);
    }
}

void print(const NamedMeasurement& named, std::FILE* to) {
    const WorstCaseMeasurement& m = named.measured;
    fmt::print(to, "{}, {} of {} multiprocessors; axis data {}; {} launches, {} levels\n",
               m.device.name, m.device.multiprocessors_used, m.device.multiprocessors, named.name,
               launches_of(m.cycle), m.cycle.tree_levels);
    print_calls(m.cycle, to);
    fmt::print(to, "\n{:<12} {:<14} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "layout", "beside it",
               "p50 us", "p99", "p99.9", "max", "3/N");
    for (const WorstCaseMeasurement::Line& line : m.lines) {
        const CyclePercentiles us = percentiles_of(line.cycle_us);
        fmt::print(to, "{:<12} {:<14} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1e}\n", line.layout,
                   line.condition, us.p50_us, us.p99_us, us.p999_us, us.max_us, us.three_over_n);
    }
    fmt::print(to, "slowest of all: {:.1f} us\n", m.us_max);
}

/// p99 of every line, a column for each kernel.
void print_columns(const std::vector<NamedMeasurement>& all, std::FILE* to) {
    fmt::print(to, "\np99 us\n{:<12} {:<14}", "layout", "beside it");
    for (const NamedMeasurement& named : all) {
        fmt::print(to, " {:>10}", named.name);
    }
    for (const WorstCaseMeasurement::Line& line : all.front().measured.lines) {
        fmt::print(to, "\n{:<12} {:<14}", line.layout, line.condition);
        for (const NamedMeasurement& named : all) {
            for (const WorstCaseMeasurement::Line& other : named.measured.lines) {
                if (other.layout == line.layout && other.condition == line.condition) {
                    fmt::print(to, " {:>10.1f}", percentiles_of(other.cycle_us).p99_us);
                }
            }
        }
    }
    fmt::print(to, "\n");
}

/// Makes the cycles to measure. False if the machine cannot be read.
bool make_cycles(const WorstCaseBenchmarkOptions& options, std::vector<WorstCaseCycle>& cycles) {
    LoadedMachine loaded;
    std::uint32_t tree_levels = 2;
    if (!options.machine.empty()) {
        if (!load(options.machine, "", loaded, stderr)) {
            return false;
        }
        tree_levels = tree_levels_of(loaded);
    }
    tree_levels = options.tree_levels != 0 ? options.tree_levels : tree_levels;
    if (options.stages == 0) {
        cycles = {batch_cycle(loaded.machine.capacities, options.launches)};
        cycles.front().tree_levels = tree_levels;
    } else {
        loaded.machine.cycle.stages = options.stages;
        cycles = longest_gpu_cycles(loaded.machine.capacities, cycle_demand(loaded.machine, true),
                                    tree_levels);
    }
    for (WorstCaseCycle& cycle : cycles) {
        cycle.count = options.cycles;
    }
    return true;
}

}  // namespace

int run_worst_case_benchmark(const WorstCaseBenchmarkOptions& options) {
    std::vector<WorstCaseCycle> cycles;
    if (!make_cycles(options, cycles)) {
        return kExitInput;
    }
    CudaOptions cuda;
    cuda.multiprocessors = options.sms;
    std::vector<NamedMeasurement> all;
    std::string fault = leaf_kernels().empty() ? kNoCudaInThisBuild : "";
    for (const LeafKernel& kernel : leaf_kernels()) {
        if (options.axis_data != "all" && options.axis_data != kernel.name) {
            continue;
        }
        cuda.launch_leaves = kernel.launch;
        for (std::size_t i = 0; i < cycles.size() && fault.empty(); ++i) {
            if (auto measured = measure_worst_case(cuda, cycles[i], fault)) {
                const std::string name = std::string(kernel.name) + (i == 0 ? "" : ", jog");
                all.push_back({name, std::move(*measured)});
                print(all.back(), options.json.words());
            }
        }
    }
    if (!fault.empty()) {
        fmt::print(stderr, "axguard-lab bench: {}\n", fault);
        return kExitGpu;
    }
    if (all.size() > 1) {
        print_columns(all, options.json.words());
    }
    return write_json(options.json, describe_worst_case(all)) ? kExitClean : kExitInternal;
}

}  // namespace axg
