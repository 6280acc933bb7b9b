// SPDX-License-Identifier: Apache-2.0
// The picture of speed against accuracy, in two panels: contacts missed, which is the danger, and
// gaps undecided or called contacts, which is the cost. Right is slower, up is worse.
#pragma once

#include <span>
#include <string>

#include "hil_replay/lab/chart/method_scores.hpp"

namespace axg::chart {

/// The table's text: one line a method.
[[nodiscard]] std::string speed_accuracy_table(std::span<const MethodScore> scores);

/// @param cases, machine  two lines under the picture: on what it was measured
[[nodiscard]] std::string speed_accuracy_script(std::span<const MethodScore> scores,
                                                const std::string& cases,
                                                const std::string& machine);

}  // namespace axg::chart
