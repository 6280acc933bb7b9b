// SPDX-License-Identifier: Apache-2.0
// The seed paper's experiment on the paper's numbers of triangles: eight pairs of bodies at random
// poses, each queried by every method of this comparison, CPU and GPU. Times in us.
// docs/theory/paper-mode.md.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "cuda/paper/paper_gpu.hpp"

namespace axg {

struct PaperBenchmarkOptions {
    std::string data;  // holds config/machines/paper-trunnion.yaml
    std::uint32_t poses = 400, passes = 3;
    std::uint32_t multiprocessors = 0;  // of the GPU; 0: all
    std::uint64_t seed = 1;
    std::uint32_t cycles = 0;  // launches of every pair of a pose, for percentiles; 0: none
    bool use_gpu = true;
};

/// One method's times and counts, [pose][pair].
struct PaperSeries {
    std::string name;
    std::vector<double> us;  // least of the passes
    std::vector<paper::Found> found;
};

/// One choice of techniques on the GPU: the device's time of whole poses, one graph for all.
struct TechniqueSeries {
    paper::Techniques techniques;
    PaperSeries series;
};

/// Operating-range pruning: the naive test of the triangles that a travel proof leaves.
struct WithinTravel {
    PaperSeries cpu;
    std::uint64_t triangle_pairs = 0;  // left, of all pairs of bodies
};

struct PaperBenchmark {
    PaperBenchmarkOptions options;
    std::vector<std::string> pairs;
    std::vector<std::uint64_t> triangle_pairs;  // [pairs]
    std::string lanes;
    std::vector<PaperSeries> cpu;  // naive, certified, engine
    WithinTravel within_travel;
    // Empty without a GPU, with the reason in `no_gpu`.
    std::vector<PaperSeries> gpu;  // naive, all techniques, certified: with launch and return
    std::vector<TechniqueSeries> techniques;
    // A pose at once: certified with launch and return, its device time, the CUDA engine.
    std::vector<PaperSeries> together;
    std::vector<double> every_pair_us;  // certified, a pose a launch, each of options.cycles
    paper::Device device;
    std::vector<paper::KernelFacts> kernels;
    std::string no_gpu;

    [[nodiscard]] std::size_t pose_count() const { return cpu.at(0).us.size() / pairs.size(); }
};

/// Runs everything. Returns 0, or another exit code after printing the reason to `messages`.
[[nodiscard]] int run_paper_benchmark(const PaperBenchmarkOptions& options, PaperBenchmark& out,
                                      std::FILE* messages);

/// Number of queries with a different hit, and with a different number of touching pairs.
struct Differences {
    std::size_t hits = 0, counts = 0;
};
[[nodiscard]] Differences differences(const PaperSeries& a, const PaperSeries& b);

void print_paper_benchmark(const PaperBenchmark& benchmark, std::FILE* words);
/// For --json, as text.
[[nodiscard]] std::string describe_paper_benchmark(const PaperBenchmark& benchmark);

}  // namespace axg
