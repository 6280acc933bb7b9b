// SPDX-License-Identifier: Apache-2.0
// The figure of speed against accuracy, in two panels: missed contacts (the danger), and gaps left
// undecided or called contacts (the cost). Right is slower, up is worse.
#pragma once

#include <span>
#include <string>

#include "hil_replay/lab/chart/method_scores.hpp"

namespace axg::chart {

/// The table's text: one line per method.
[[nodiscard]] std::string speed_accuracy_table(std::span<const MethodScore> scores);

/// @param cases, machine  two lines under the figure: measured pairs and processor
[[nodiscard]] std::string speed_accuracy_script(std::span<const MethodScore> scores,
                                                const std::string& cases,
                                                const std::string& machine);

}  // namespace axg::chart
