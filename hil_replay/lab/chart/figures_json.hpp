// SPDX-License-Identifier: Apache-2.0
// Figure::summary of each figure that has one: the counts and times behind it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/lab/chart/method_scores.hpp"

namespace axg::chart {

[[nodiscard]] std::string describe_methods(const std::vector<MethodScore>& scores, unsigned passes,
                                           const std::string& processor);

/// Errors of one method's clearances.
struct ClearanceErrors {
    std::string method;
    bool is_certified = false;
    std::uint64_t count = 0, above = 0;
    double most_above_um = 0, most_below_um = 0;
};
[[nodiscard]] std::string describe_clearance_errors(const std::vector<ClearanceErrors>& methods);

/// Verdict changes of one method, summed over all frames.
struct FlipTotals {
    std::string method;
    bool is_certified = false;
    std::uint64_t differing = 0, wrong = 0;
};
[[nodiscard]] std::string describe_flips(const std::vector<FlipTotals>& methods, std::size_t pairs,
                                         std::size_t orders);

/// The query with most rechecks in a family of cycles.
struct RecheckNeeds {
    std::string family, pair, axes;
    std::uint64_t cycles = 0;
    std::uint32_t rechecks = 0;
    std::uint64_t over_capacity = 0;
};
[[nodiscard]] std::string describe_rechecks(std::uint32_t capacity,
                                            const std::vector<RecheckNeeds>& families);

/// Gaps that one method leaves undecided at one aspect ratio of triangles.
struct UndecidedGap {
    std::string method;
    double aspect = 1;
    std::uint64_t pairs = 0;
    double widest_undecided_um = 0;
};
[[nodiscard]] std::string describe_undecided_gaps(const std::vector<UndecidedGap>& curves);

}  // namespace axg::chart
