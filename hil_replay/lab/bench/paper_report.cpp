// SPDX-License-Identifier: Apache-2.0
// The seed paper's tables, and ours beside them.
#include <fmt/format.h>

#include <algorithm>

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

/// Averages divided; below 1 the GPU is the slower one.
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

void print_beside_paper(const PaperBenchmark& benchmark, std::FILE* words) {
    const auto found = std::find(benchmark.pairs.begin(), benchmark.pairs.end(), kPaperPair);
    const auto pair = static_cast<std::size_t>(found - benchmark.pairs.begin());
    fmt::print(words,
               "\nbeside the seed paper (a Tesla K20c, its own shapes; what is not here of its "
               "tables we have not seen)\n{:<38}{:>11}{:>11}{:>11}\n",
               "us", "paper", "here", "factor");
    const auto line = [words](const char* what, double paper_us, double us) {
        fmt::print(words, "{:<38}{:>11.0f}{:>11.2f}{:>11.0f}\n", what, paper_us, us, paper_us / us);
    };
    line("cutter-c, naive CPU, average", kPaperCpuUs,
         of_pair(benchmark, benchmark.cpu[0], pair).average);
    line("eight pairs, CPU engine, average", kPaperSumUs,
         of_pose(benchmark, benchmark.cpu[2]).average);
    if (benchmark.gpu.empty()) {
        return;
    }
    const Spread one = of_pair(benchmark, benchmark.gpu[1], pair),
                 pose = of_pose(benchmark, benchmark.gpu[1]);
    line("cutter-c, GPU techniques, average", kPaperGpuUs, one.average);
    line("cutter-c, GPU techniques, worst", kPaperGpuUsMax, one.most);
    line("eight pairs, GPU techniques, average", kPaperSumUs, pose.average);
    line("eight pairs, GPU techniques, worst", kPaperSumUsMax, pose.most);
    line("eight pairs, GPU certified, average", kPaperSumUs,
         of_pose(benchmark, benchmark.together[0]).average);
    line("eight pairs, CUDA engine, average", kPaperSumUs,
         of_pose(benchmark, benchmark.together[2]).average);
    fmt::print(words, "CPU over GPU: paper {}, here {:.1f} (naive CPU over GPU techniques)\n",
               kPaperSpeedUp, of_pose(benchmark, benchmark.cpu[0]).average / pose.average);
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
    print_agreement(benchmark, words);
    if (!benchmark.kernels.empty()) {
        print_kernels(benchmark, words);
    }
}

}  // namespace axg
