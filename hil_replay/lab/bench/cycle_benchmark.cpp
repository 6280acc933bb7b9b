// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/lab/bench/cycle_benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/certificate/stop_certificate.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/setup/choose_plan.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/measure_cycle.hpp"
#include "hil_replay/lab/bench/bench_json.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

LaneSet lane_set(const std::string& name) {
    return name == "avx512" ? LaneSet::avx512
           : name == "avx2" ? LaneSet::avx2
           : name == "neon" ? LaneSet::neon
                            : LaneSet::widest;
}

void print(const CycleMeasurement& m, std::FILE* to) {
    fmt::print(to, "{} lanes; {} pairs with each tool; {}\nposing {:.1f} us; trees {} kB\n\n",
               m.lanes, m.tasks, format_plan(m.plan), m.posing.wall_us, m.memory_bytes / 1000);
    fmt::print(to,
               "{:<12}{:>5}{:>6} {:<16}{:>8}{:>7}{:>7}{:>7}{:>8}{:>9} {:>8} {:>8} {:>8} {:>8}\n",
               "layout", "open", "parts", "caches", "queries", "nodes", "leaves", "rows", "triang.",
               "rechecks", "wall us", "cpu us", "p50", "max");
    for (const CycleLine& line : m.lines) {
        const CyclePercentiles us = percentiles_of(line.wall_us);
        const WorkLists work = sum_of(line.work);
        fmt::print(
            to,
            "{:<12}{:>5}{:>6} {:<16}{:>8}{:>7}{:>7}{:>7}{:>8}{:>9} {:>8.1f} {:>8.1f} {:>8.1f} "
            "{:>8.1f}\n",
            name_of(line.shape.layout), line.shape.open, line.shape.parts, name_of(line.condition),
            queries_of(line.work), work.node_pairs, work.leaf_pairs, work.box_rows,
            work.triangle_pairs, work.rechecks, line.least.wall_us, line.least.cpu_us, us.p50_us,
            us.max_us);
    }
    const auto most_cpu = std::max_element(
        m.lines.begin(), m.lines.end(),
        [](const CycleLine& a, const CycleLine& b) { return a.least.cpu_us < b.least.cpu_us; });
    fmt::print(
        to,
        "\nlongest: {:.1f} us wall time, {:.1f} us thread time ({}, {}); each the minimum of {}\n",
        m.longest_us(), most_cpu->least.cpu_us, name_of(m.lines[m.longest].shape.layout),
        name_of(m.lines[m.longest].condition), kCycleRepeats);
}

}  // namespace

int run_cycle_benchmark(const CycleBenchmarkOptions& options) {
    LoadedMachine loaded;
    if (!load(options.machine, "", loaded, stderr)) {
        return kExitInput;
    }
    const CyclePlan plan = plan_at(loaded.machine, stop_tasks(loaded.machine), options.step);
    CycleMeasureOptions measure;
    measure.lanes = lane_set(options.lanes);
    const auto lines = static_cast<std::uint32_t>(
        kCycleLayouts.size() * cycle_shapes(plan, stop_tasks(loaded.machine)).size() *
        measure.conditions.size());
    measure.groups_of_repeats = std::max(1U, options.cycles / (lines * kCycleRepeats));
    std::string fault;
    const std::optional<CycleMeasurement> measured = measure_cycle(loaded, plan, measure, fault);
    if (!measured) {
        fmt::print(stderr, "axguard-lab bench: {}\n", fault);
        return kExitInput;
    }
    print(*measured, options.json.words());
    return write_json(options.json, describe_cycles(*measured)) ? kExitClean : kExitInternal;
}

}  // namespace axg
