// SPDX-License-Identifier: Apache-2.0
// How long methods take for a pair, on one core, all on the same pairs and in turns: what else the
// machine does meets all of them alike.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

struct PairTime {
    double least_ns = 0, median_ns = 0;  // a pair, over the passes
};

/// Random triangles of some millimetres whose boxes overlap: what a tree leaves to the test.
/// Deterministic in its arguments.
[[nodiscard]] PairSet overlapping_pairs(std::size_t count, std::uint64_t seed);

/// Those of them that intersect: nothing separates them, so no axis of a separating-axis method is
/// left out by an early exit.
[[nodiscard]] PairSet intersecting_pairs(std::size_t count, std::uint64_t seed);

/// Verdicts of every pair, `passes` times, the methods in turns; no distances. The clock runs
/// around one whole batch: what a method likes its pairs to look like was made before.
/// Precondition: passes > 0, pairs not empty.
[[nodiscard]] std::vector<PairTime> time_methods(std::span<const Method* const> methods,
                                                 const PairSet& pairs, unsigned passes);

}  // namespace axg::lab
