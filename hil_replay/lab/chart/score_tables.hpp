// SPDX-License-Identifier: Apache-2.0
// Tables of the scores: speed against accuracy, the failure map (methods by categories of pairs),
// and the first failing case of each method in hexadecimal floats, for manual tests.
#pragma once

#include <span>
#include <string>

#include "hil_replay/lab/chart/method_scores.hpp"

namespace axg::chart {

/// One line per method.
[[nodiscard]] std::string speed_accuracy_table(std::span<const MethodScore> scores);

/// One line per method and category with a missed contact, a false hit or an undecided gap;
/// of the first method one line per category.
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

}  // namespace axg::chart
