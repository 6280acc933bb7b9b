// SPDX-License-Identifier: Apache-2.0
// The numbers of both reports on the seed paper's experiment, in words and as JSON.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hil_replay/lab/bench/paper_benchmark.hpp"
#include "hil_replay/lab/bench/paper_tables.hpp"

namespace axg {

/// Times of one pair over all poses.
[[nodiscard]] Spread of_pair(const PaperBenchmark& benchmark, const PaperSeries& series,
                             std::size_t pair);
/// Times of a pose, summed over its pairs.
[[nodiscard]] Spread of_pose(const PaperBenchmark& benchmark, const PaperSeries& series);

[[nodiscard]] double per_pose(const PaperBenchmark& benchmark, const PaperSeries& series,
                              std::uint32_t paper::Found::*count);
[[nodiscard]] std::size_t hits_of(const PaperSeries& series);
/// "none", "all but carry", "boxes, unroll"; "coalesced" excludes the others.
[[nodiscard]] std::string name_of(const paper::Techniques& techniques);
[[nodiscard]] std::vector<const PaperSeries*> all_series(const PaperBenchmark& benchmark);

}  // namespace axg
