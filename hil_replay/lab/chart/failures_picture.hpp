// SPDX-License-Identifier: Apache-2.0
// The failure map: methods by categories of pairs, and the first failing case of each method in
// hexadecimal floats, for manual tests.
#pragma once

#include <span>
#include <string>

#include "hil_replay/lab/chart/method_scores.hpp"

namespace axg::chart {

/// One line per method and category with a missed contact, a false hit or an undecided gap.
[[nodiscard]] std::string failure_map_table(std::span<const MethodScore> scores);

/// First and deepest missed contact, first and farthest false hit of every method, all eighteen
/// coordinates.
[[nodiscard]] std::string failing_cases_table(std::span<const MethodScore> scores,
                                              const CaseBook& book,
                                              std::span<const lab::Method* const> methods);

/// The same as readable text, without the methods compiled with contraction.
[[nodiscard]] std::string format_failing_cases(std::span<const MethodScore> scores,
                                               const CaseBook& book,
                                               std::span<const lab::Method* const> methods);

/// Map of the contacts that a method calls separated.
[[nodiscard]] std::string missed_script(std::span<const MethodScore> scores,
                                        const std::string& beneath);
/// Map of the pairs more than 1 um apart that a method calls intersecting or leaves undecided.
[[nodiscard]] std::string not_told_apart_script(std::span<const MethodScore> scores,
                                                const std::string& beneath);

}  // namespace axg::chart
