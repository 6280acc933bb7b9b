// SPDX-License-Identifier: Apache-2.0
// The failure map: methods by categories of pairs, and the first failing case of each method in
// hexadecimal floats, to be tried by hand.
#pragma once

#include <span>
#include <string>

#include "hil_replay/lab/chart/method_scores.hpp"

namespace axg::chart {

/// One line a method and category where it missed, invented or left undecided anything.
[[nodiscard]] std::string failure_map_table(std::span<const MethodScore> scores);

/// First and deepest missed contact, first and farthest false hit of every method, all eighteen
/// coordinates.
[[nodiscard]] std::string failing_cases_table(std::span<const MethodScore> scores,
                                              const CaseBook& book,
                                              std::span<const lab::Method* const> methods);

/// The same for people; methods compiled with contraction stay in the table.
[[nodiscard]] std::string format_failing_cases(std::span<const MethodScore> scores,
                                               const CaseBook& book,
                                               std::span<const lab::Method* const> methods);

/// Contacts called separated.
[[nodiscard]] std::string missed_script(std::span<const MethodScore> scores,
                                        const std::string& beneath);
/// Pairs apart that were called intersecting, or left undecided.
[[nodiscard]] std::string not_told_apart_script(std::span<const MethodScore> scores,
                                                const std::string& beneath);

}  // namespace axg::chart
