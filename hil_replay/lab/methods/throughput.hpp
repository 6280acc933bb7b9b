// SPDX-License-Identifier: Apache-2.0
// Times methods per pair on one core. All run in turns on the same pairs, so that other load of the
// machine affects all of them alike.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

struct PairTime {
    double least_ns = 0, median_ns = 0;  // a pair, over the passes
};

/// Random triangles of some millimetres whose boxes overlap, as the traversal of trees passes them
/// to the test. Deterministic in its arguments.
[[nodiscard]] PairSet overlapping_pairs(std::size_t count, std::uint64_t seed);

/// Random pairs as above that intersect: no axis separates them, so a separating-axis method tests
/// all its axes without an early exit.
[[nodiscard]] PairSet intersecting_pairs(std::size_t count, std::uint64_t seed);

/// Judges every pair `passes` times, the methods in turns, without distances. The clock runs around
/// one whole batch; `pairs` contains every layout that a method needs.
/// Precondition: passes > 0, pairs not empty.
[[nodiscard]] std::vector<PairTime> time_methods(std::span<const Method* const> methods,
                                                 const PairSet& pairs, unsigned passes);

}  // namespace axg::lab
