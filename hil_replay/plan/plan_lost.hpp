// SPDX-License-Identifier: Apache-2.0
// The results that a coarser model of a machine does not give any more, by name: for the table
// lost.csv, and the first of them as words (docs/reference/plan.md).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hil_replay/plan/model_choice.hpp"

namespace axg {

/// How many of a model's the words name.
inline constexpr std::size_t kLostNamed = 3;

/// "table-cutter at X 12.5 Z -3 (contact); ... and 4 more"; empty where none is.
[[nodiscard]] std::string format_lost(const Machine& machine, const ModelCandidate& model);

/// A line for each pair: model, what, sample of the trace, pair, position of each axis (mm, deg).
[[nodiscard]] std::string csv_of_lost(const Machine& machine,
                                      const std::vector<ModelCandidate>& models);

}  // namespace axg
