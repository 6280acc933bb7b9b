// SPDX-License-Identifier: Apache-2.0
// The seed paper's tables, and ours beside them.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil_replay/lab/bench/paper_benchmark.hpp"
#include "hil_replay/replay/cycle_times.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

// What is known to us of the seed paper's results (Siao, Lin, Chien, Chang, 2021; a Tesla K20c):
// the pair Cutter-C, and sums over the eight pairs. The other cells of its tables we have not seen,
// and leave empty.
constexpr const char* kPaperPair = "cutter-c";
constexpr double kPaperCpuUs = 89698, kPaperGpuUs = 2260, kPaperGpuUsMax = 3109;
constexpr double kPaperSumUs = 6045, kPaperSumUsMax = 9372, kPaperSpeedUp = 37.1;

struct Spread {
    double average = 0, least = 0, most = 0;
};

Spread spread_of(const std::vector<double>& values) {
    Spread s{0, values.front(), values.front()};
    for (const double value : values) {
        s.average += value;
        s.least = std::min(s.least, value);
        s.most = std::max(s.most, value);
    }
    s.average /= static_cast<double>(values.size());
    return s;
}

Spread of_pair(const PaperBenchmark& benchmark, const PaperSeries& series, std::size_t pair) {
    std::vector<double> us;
    for (std::size_t i = pair; i < series.us.size(); i += benchmark.pairs.size()) {
        us.push_back(series.us[i]);
    }
    return spread_of(us);
}

/// All pairs of a pose together.
Spread of_pose(const PaperBenchmark& benchmark, const PaperSeries& series) {
    std::vector<double> us(benchmark.pose_count(), 0.0);
    for (std::size_t i = 0; i < series.us.size(); ++i) {
        us[i / benchmark.pairs.size()] += series.us[i];
    }
    return spread_of(us);
}

double per_pose(const PaperBenchmark& benchmark, const PaperSeries& series,
                std::uint32_t paper::Found::*count) {
    double sum = 0;
    for (const paper::Found& found : series.found) {
        sum += found.*count;
    }
    return sum / static_cast<double>(benchmark.pose_count());
}

std::size_t hits_of(const PaperSeries& series) {
    return static_cast<std::size_t>(
        std::count_if(series.found.begin(), series.found.end(),
                      [](const paper::Found& found) { return found.touching != 0; }));
}

std::string name_of(const paper::Techniques& t) {
    const std::pair<bool, const char*> parts[] = {{t.boxes, "boxes"},
                                                  {t.interchange, "interchange"},
                                                  {t.unroll, "unroll"},
                                                  {t.prefetch, "prefetch"},
                                                  {t.carry, "carry"}};
    std::string on, off;
    int count = 0;
    for (const auto& [is_on, name] : parts) {
        (is_on ? on : off) += std::string((is_on ? on : off).empty() ? "" : ", ") + name;
        count += is_on ? 1 : 0;
    }
    return count == 0 ? "none" : count == 5 ? "all" : count == 4 ? "all but " + off : on;
}

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
        const Json us = describe_cycles(benchmark.every_pair_us);
        fmt::print(words,
                   "every pair of a pose, certified, {} launches: p50 {:.1f} us, p99 {:.1f}, p99.9 "
                   "{:.1f}, max {:.1f}, 3/N {:.1e}\n",
                   benchmark.every_pair_us.size(), us["p50"].get<double>(), us["p99"].get<double>(),
                   us["p999"].get<double>(), us["max"].get<double>(),
                   us["three_over_n"].get<double>());
    }
}

std::vector<const PaperSeries*> all_series(const PaperBenchmark& benchmark) {
    std::vector<const PaperSeries*> all;
    for (const std::vector<PaperSeries>* const list :
         {&benchmark.cpu, &benchmark.gpu, &benchmark.together}) {
        for (const PaperSeries& series : *list) {
            all.push_back(&series);
        }
    }
    return all;
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

Json describe_paper_benchmark(const PaperBenchmark& benchmark) {
    Json out{{"bench", "paper"},
             {"poses", benchmark.pose_count()},
             {"seed", benchmark.options.seed},
             {"passes", benchmark.options.passes},
             {"lanes", benchmark.lanes},
             {"triangle_pairs", Json::object()},
             {"seed_paper",
              {{"pair", kPaperPair},
               {"cpu_avg_us", kPaperCpuUs},
               {"gpu_avg_us", kPaperGpuUs},
               {"gpu_max_us", kPaperGpuUsMax},
               {"sum_of_averages_us", kPaperSumUs},
               {"worst_us", kPaperSumUsMax},
               {"speed_up", kPaperSpeedUp}}}};
    for (std::size_t pair = 0; pair < benchmark.pairs.size(); ++pair) {
        out["triangle_pairs"][benchmark.pairs[pair]] = benchmark.triangle_pairs[pair];
    }
    Json& methods = out["methods"] = Json::array();
    for (const PaperSeries* const series : all_series(benchmark)) {
        methods.push_back(json_of(benchmark, *series));
    }
    if (benchmark.gpu.empty()) {
        out["no_gpu"] = benchmark.no_gpu;
        return out;
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
                             {"cycle_us", describe_cycles(benchmark.every_pair_us)}};
    }
    Json& kernels = out["kernels"] = Json::array();
    for (const paper::KernelFacts& kernel : benchmark.kernels) {
        kernels.push_back({{"name", kernel.name},
                           {"registers", kernel.registers},
                           {"shared_bytes", kernel.shared_bytes},
                           {"local_bytes", kernel.local_bytes}});
    }
    return out;
}

}  // namespace axg
