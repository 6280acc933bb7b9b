// SPDX-License-Identifier: Apache-2.0
// Prints the seed paper's tables next to ours.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "hil_replay/lab/bench/paper_benchmark.hpp"
#include "hil_replay/lab/bench/paper_sums.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

void print_times(const PaperBenchmark& benchmark, const std::vector<PaperSeries>& methods,
                 std::FILE* words) {
    fmt::print(words, "\n{:<10}", "us");
    for (const PaperSeries& method : methods) {
        fmt::print(words, " | {:^27}", method.name);
    }
    fmt::print(words, "\n{:<10}", "pair");
    for (std::size_t i = 0; i < methods.size(); ++i) {
        fmt::print(words, " | {:>9}{:>9}{:>9}", "AVG", "MIN", "MAX");
    }
    const auto cells = [&](const Spread& s) {
        fmt::print(words, " | {:>9.2f}{:>9.2f}{:>9.2f}", s.average, s.least, s.most);
    };
    for (std::size_t pair = 0; pair < benchmark.pairs.size(); ++pair) {
        fmt::print(words, "\n{:<10}", benchmark.pairs[pair]);
        for (const PaperSeries& method : methods) {
            cells(of_pair(benchmark, method, pair));
        }
    }
    fmt::print(words, "\n{:<10}", "a pose");
    for (const PaperSeries& method : methods) {
        cells(of_pose(benchmark, method));
    }
    fmt::print(words, "\n");
}

/// Ratios of averages; below 1, the second method of a column is the slower one.
void print_factors(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words,
               "\nby averages   CPU naive / GPU techniques   CPU naive / CPU engine   CPU engine / "
               "GPU techniques\n");
    const auto line = [&](const std::string& name, double naive, double engine, double gpu) {
        fmt::print(words, "{:<12}{:>28.2f}{:>25.0f}{:>30.4f}\n", name, naive / gpu, naive / engine,
                   engine / gpu);
    };
    for (std::size_t pair = 0; pair < benchmark.pairs.size(); ++pair) {
        line(benchmark.pairs[pair], of_pair(benchmark, benchmark.cpu[0], pair).average,
             of_pair(benchmark, benchmark.cpu[2], pair).average,
             of_pair(benchmark, benchmark.gpu[1], pair).average);
    }
    line("a pose", of_pose(benchmark, benchmark.cpu[0]).average,
         of_pose(benchmark, benchmark.cpu[2]).average,
         of_pose(benchmark, benchmark.gpu[1]).average);
}

/// Rows of `series` next to the paper's: three times, each with the ratio of the paper's to ours.
void print_rows_beside(const PaperBenchmark& benchmark, const PaperSeries& series,
                       Spread PaperRow::*times, const char* title, std::FILE* words) {
    fmt::print(words, "\n{:<9} | {:^29} | {:^29} | {:^24}\n", "us", title, series.name,
               "paper / here");
    fmt::print(words, "{:<9} | {:>9}{:>10}{:>10} | {:>9}{:>10}{:>10} | {:>8}{:>8}{:>8}\n", "pair",
               "AVG", "MIN", "MAX", "AVG", "MIN", "MAX", "AVG", "MIN", "MAX");
    const auto line = [words](std::string_view name, const Spread& a, const Spread& b) {
        fmt::print(words,
                   "{:<9} | {:>9.2f}{:>10.2f}{:>10.2f} | {:>9.2f}{:>10.2f}{:>10.2f} | "
                   "{:>8.1f}{:>8.1f}{:>8.1f}\n",
                   name, a.average, a.least, a.most, b.average, b.least, b.most,
                   a.average / b.average, a.least / b.least, a.most / b.most);
    };
    Spread sum;
    for (const PaperRow& row : kPaperRows) {
        const auto pair = std::find(benchmark.pairs.begin(), benchmark.pairs.end(), row.pair);
        const Spread ours =
            of_pair(benchmark, series, static_cast<std::size_t>(pair - benchmark.pairs.begin()));
        line(row.pair, row.*times, ours);
        sum = {sum.average + ours.average, sum.least + ours.least, sum.most + ours.most};
    }
    line("sum", paper_sum(times), sum);
}

/// Ratio of the averages, CPU over GPU: the paper's last column.
void print_speed_ups(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words, "\n{:<9}{:>18}{:>50}\n", "speed-up", "paper, CPU / GPU",
               "here, CPU naive / GPU techniques");
    double mean = 0;
    for (const PaperRow& row : kPaperRows) {
        const auto found = std::find(benchmark.pairs.begin(), benchmark.pairs.end(), row.pair);
        const auto pair = static_cast<std::size_t>(found - benchmark.pairs.begin());
        const double here = of_pair(benchmark, benchmark.cpu[0], pair).average /
                            of_pair(benchmark, benchmark.gpu[1], pair).average;
        mean += here / static_cast<double>(kPaperRows.size());
        fmt::print(words, "{:<9}{:>18.2f}{:>50.2f}\n", row.pair, row.speed_up, here);
    }
    fmt::print(words, "{:<9}{:>18.1f}{:>50.1f}\n", "mean", kPaperSpeedUp, mean);
}

/// All figures of the paper's tables 2 and 3. Our GPU columns need a GPU on this host.
void print_beside_paper(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words,
               "\nthe seed paper's tables, pair by pair (its own shapes; a Tesla K20c and its "
               "CPU)\n");
    print_rows_beside(benchmark, benchmark.cpu[0], &PaperRow::cpu, "paper, table 2: CPU", words);
    print_rows_beside(benchmark, benchmark.cpu[2], &PaperRow::gpu, "paper, table 3: K20c", words);
    if (!benchmark.gpu.empty()) {
        print_rows_beside(benchmark, benchmark.gpu[1], &PaperRow::gpu, "paper, table 3: K20c",
                          words);
        print_speed_ups(benchmark, words);
        return;
    }
    fmt::print(words, "\n{:<9}{:>18}   (no GPU here)\n", "speed-up", "paper, CPU / GPU");
    for (const PaperRow& row : kPaperRows) {
        fmt::print(words, "{:<9}{:>18.2f}\n", row.pair, row.speed_up);
    }
    fmt::print(words, "{:<9}{:>18.1f}\n", "mean", kPaperSpeedUp);
}

/// Two lines of the paper's text: pruning by the operating range, and the order in memory.
void print_range_and_access(const PaperBenchmark& benchmark, std::FILE* words) {
    std::uint64_t all = 0;
    for (const std::uint64_t count : benchmark.triangle_pairs) {
        all += count;
    }
    const double whole = of_pose(benchmark, benchmark.cpu[0]).average;
    const double pruned = of_pose(benchmark, benchmark.within_travel.cpu).average;
    fmt::print(words,
               "\noperating-range pruning, CPU naive: {} of {} pairs of triangles left; {:.2f} us "
               "a pose, {:.2f} without; hits unlike naive {}\n",
               benchmark.within_travel.triangle_pairs, all, pruned, whole,
               differences(benchmark.within_travel.cpu, benchmark.cpu[0]).hits);
    const auto series = [&benchmark](const char* name) {
        return std::find_if(
            benchmark.techniques.begin(), benchmark.techniques.end(),
            [name](const TechniqueSeries& t) { return name_of(t.techniques) == name; });
    };
    const auto strided = series("none"), coalesced = series("coalesced");
    if (strided == benchmark.techniques.end() || coalesced == benchmark.techniques.end()) {
        fmt::print(words, "coalesced against strided access: needs a GPU\n");
        return;
    }
    const double apart = of_pose(benchmark, strided->series).average;
    const double together = of_pose(benchmark, coalesced->series).average;
    fmt::print(words,
               "coalesced access, on the device: {:.2f} us a pose, strided {:.2f}; {:.2f} times as "
               "fast; hits unlike naive {}\n",
               together, apart, apart / together,
               differences(coalesced->series, benchmark.cpu[0]).hits);
}

void print_techniques(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words,
               "\ntechniques: us of the device for a pose of eight pairs, all poses one graph\n"
               "{:<22}{:>10}{:>10}{:>10}{:>12}{:>15}{:>20}\n",
               "on", "AVG", "MIN", "MAX", "x faster", "pairs tested", "hits unlike naive");
    const double slowest = of_pose(benchmark, benchmark.techniques.front().series).average;
    for (const TechniqueSeries& line : benchmark.techniques) {
        const Spread s = of_pose(benchmark, line.series);
        fmt::print(words, "{:<22}{:>10.2f}{:>10.2f}{:>10.2f}{:>12.2f}{:>15.0f}{:>20}\n",
                   name_of(line.techniques), s.average, s.least, s.most, slowest / s.average,
                   per_pose(benchmark, line.series, &paper::Found::tested),
                   differences(line.series, benchmark.cpu[0]).hits);
    }
}

void print_certified(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words, "\neight pairs of bodies at once, certified: us a pose\n");
    for (const PaperSeries& series : benchmark.together) {
        const Spread s = of_pose(benchmark, series);
        fmt::print(words, "{:<26}{:>10.2f}{:>10.2f}{:>10.2f}\n", series.name, s.average, s.least,
                   s.most);
    }
    fmt::print(words,
               "of {:.0f} pairs of triangles the first stage leaves {:.0f}; boxes leave the CUDA "
               "engine {:.0f}\n",
               per_pose(benchmark, benchmark.together[0], &paper::Found::tested),
               per_pose(benchmark, benchmark.together[0], &paper::Found::left),
               per_pose(benchmark, benchmark.together[2], &paper::Found::tested));
    if (!benchmark.every_pair_us.empty()) {
        const CyclePercentiles us = percentiles_of(benchmark.every_pair_us);
        fmt::print(words,
                   "every pair of a pose, certified, {} launches: p50 {:.1f} us, p99 {:.1f}, p99.9 "
                   "{:.1f}, max {:.1f}, 3/N {:.1e}\n",
                   benchmark.every_pair_us.size(), us.p50_us, us.p99_us, us.p999_us, us.max_us,
                   us.three_over_n);
    }
}

void print_agreement(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words,
               "\nof {} questions           touching   unlike CPU naive: hit   count   unlike CPU "
               "engine: hit   count\n",
               benchmark.cpu[0].us.size());
    for (const PaperSeries* const series : all_series(benchmark)) {
        const Differences naive = differences(*series, benchmark.cpu[0]);
        const Differences engine = differences(*series, benchmark.cpu[2]);
        fmt::print(words, "{:<26}{:>12}{:>24}{:>8}{:>26}{:>8}\n", series->name, hits_of(*series),
                   naive.hits, naive.counts, engine.hits, engine.counts);
    }
}

void print_kernels(const PaperBenchmark& benchmark, std::FILE* words) {
    fmt::print(words, "\n{:<44}{:>10}{:>14}{:>26}\n", "kernel", "registers", "shared bytes",
               "stack and spills, bytes");
    for (const paper::KernelFacts& kernel : benchmark.kernels) {
        fmt::print(words, "{:<44}{:>10}{:>14}{:>26}\n", kernel.name, kernel.registers,
                   kernel.shared_bytes, kernel.local_bytes);
    }
}

}  // namespace

void print_paper_benchmark(const PaperBenchmark& benchmark, std::FILE* words) {
    std::uint64_t triangle_pairs = 0;
    for (const std::uint64_t count : benchmark.triangle_pairs) {
        triangle_pairs += count;
    }
    fmt::print(words,
               "{} poses x {} pairs of bodies, {} pairs of triangles a pose, seed {}, least of {} "
               "passes; CPU lanes {}\n",
               benchmark.pose_count(), benchmark.pairs.size(), triangle_pairs,
               benchmark.options.seed, benchmark.options.passes, benchmark.lanes);
    if (benchmark.gpu.empty()) {
        fmt::print(words, "no GPU: {}; its columns are left out\n", benchmark.no_gpu);
    } else {
        fmt::print(words, "GPU {}, {} of {} multiprocessors, driver {}.{}, runtime {}.{}\n",
                   benchmark.device.name, benchmark.device.multiprocessors_used,
                   benchmark.device.multiprocessors, benchmark.device.driver / 1000,
                   benchmark.device.driver % 1000 / 10, benchmark.device.runtime / 1000,
                   benchmark.device.runtime % 1000 / 10);
    }
    print_times(benchmark, benchmark.cpu, words);
    if (!benchmark.gpu.empty()) {
        print_times(benchmark, benchmark.gpu, words);
        print_factors(benchmark, words);
        print_techniques(benchmark, words);
        print_certified(benchmark, words);
    }
    print_beside_paper(benchmark, words);
    print_range_and_access(benchmark, words);
    print_agreement(benchmark, words);
    if (!benchmark.kernels.empty()) {
        print_kernels(benchmark, words);
    }
}

}  // namespace axg
