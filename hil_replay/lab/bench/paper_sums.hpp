// SPDX-License-Identifier: Apache-2.0
// The numbers of both reports on the seed paper's experiment, in words and as JSON.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hil_replay/lab/bench/paper_benchmark.hpp"

namespace axg {

// What is known to us of the seed paper's results (Siao, Lin, Chien, Chang, 2021; a Tesla K20c):
// the pair Cutter-C, and sums over the eight pairs. The other cells of its tables we have not seen,
// and leave empty.
inline constexpr const char* kPaperPair = "cutter-c";
inline constexpr double kPaperCpuUs = 89698, kPaperGpuUs = 2260, kPaperGpuUsMax = 3109;
inline constexpr double kPaperSumUs = 6045, kPaperSumUsMax = 9372, kPaperSpeedUp = 37.1;

/// us
struct Spread {
    double average = 0, least = 0, most = 0;
};

/// Of one pair over all poses.
[[nodiscard]] Spread of_pair(const PaperBenchmark& benchmark, const PaperSeries& series,
                             std::size_t pair);
/// All pairs of a pose together.
[[nodiscard]] Spread of_pose(const PaperBenchmark& benchmark, const PaperSeries& series);

[[nodiscard]] double per_pose(const PaperBenchmark& benchmark, const PaperSeries& series,
                              std::uint32_t paper::Found::*count);
[[nodiscard]] std::size_t hits_of(const PaperSeries& series);
/// "none", "all but carry", "boxes, unroll".
[[nodiscard]] std::string name_of(const paper::Techniques& techniques);
[[nodiscard]] std::vector<const PaperSeries*> all_series(const PaperBenchmark& benchmark);

}  // namespace axg
