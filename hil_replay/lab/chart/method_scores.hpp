// SPDX-License-Identifier: Apache-2.0
// Scores of the laboratory's methods on pairs of triangles with results from exact arithmetic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/lab/cases/pair_set.hpp"
#include "hil_replay/lab/methods/method.hpp"

namespace axg::chart {

/// From exact arithmetic. The distance is rounded; the depth is computed in long double.
struct Truth {
    bool intersects = false;
    double distance_um = 0;
    double depth_um = 0;  // where they intersect: smallest overlap along the seventeen axes
};

[[nodiscard]] Truth truth_of(const lab::Pair<double>& pair);

/// Pairs of every category, with the truth about them.
struct Cases {
    lab::PairSet pairs;
    std::vector<std::size_t> category;  // of each pair
    std::vector<Truth> truth;
    std::vector<bool> machine_like;
};

/// The same draws in float and in double: each method gets numbers that its type represents.
struct CaseBook {
    Cases f32, f64;
    std::size_t per_category = 0;

    [[nodiscard]] const Cases& of(const lab::Method& method) const noexcept {
        return method.scalar == lab::Scalar::f64 ? f64 : f32;
    }
};

[[nodiscard]] CaseBook make_case_book(std::uint64_t seed, std::size_t per_category);

/// Whether the pair could be on a machine tool: no coordinate beyond 4 m, both triangles longer
/// than 1 um.
[[nodiscard]] bool is_machine_like(const lab::Pair<double>& pair);

/// Counts for one category, or for several. Lengths in um.
struct Score {
    std::uint64_t intersecting = 0, apart = 0;
    std::uint64_t missed = 0;  // intersecting, called separated
    double deepest_missed_um = 0;
    std::uint64_t false_hits = 0;  // apart, called intersecting
    double farthest_false_hit_um = 0;
    std::uint64_t undecided_hits = 0, undecided_apart = 0;
    double widest_undecided_um = 0;  // of those apart
    // Pairs more than 1 um apart: a distance that a machine tool resolves.
    std::uint64_t far = 0, far_false_hits = 0, far_undecided = 0;
};

inline constexpr std::size_t kNoCase = SIZE_MAX;

struct MethodScore {
    std::string name;
    bool is_certified = false, is_fused = false;
    Score machine;                   // machine-like pairs only
    std::vector<Score> by_category;  // all pairs
    // Indices of machine-like pairs.
    std::size_t first_missed = kNoCase, deepest_missed = kNoCase, first_false_hit = kNoCase,
                farthest_false_hit = kNoCase;
    double ns_touching = 0, ns_apart = 0;  // mean of a pair, least of the passes
};

[[nodiscard]] MethodScore score_of(const lab::Method& method, const CaseBook& book);

/// Fills the times: each pass runs every method once, so that a disturbance affects all methods
/// alike. Stores each method's least time.
void time_methods(const CaseBook& book, const std::vector<const lab::Method*>& methods,
                  unsigned passes, std::vector<MethodScore>& scores);

}  // namespace axg::chart
