// SPDX-License-Identifier: Apache-2.0
// What `axguard-lab chart` measures. Each is a function of its request: counts are the same for the
// same seed; times are not. Between machines the C library may move a drawn gap by a rounding.
#pragma once

#include <vector>

#include "hil_replay/lab/chart/figure.hpp"

namespace axg::chart {

inline constexpr double kDeadlineUs = 500;  // the default of deadline_us
inline constexpr const char* kDeadlineWords = "deadline, 500 µs";

/// Speed against accuracy, missed contacts, pairs not told apart: one measurement, three pictures.
[[nodiscard]] std::vector<Figure> method_figures(const Request& request);

/// Whole cycles against early stops, beside the records of other libraries.
[[nodiscard]] Figure cycle_figure(const Request& request);

/// Coarser models: time against early stops, from the records of two machines.
[[nodiscard]] Figure model_figure(const Request& request);

/// Undecided rate of the certified methods against the true gap.
[[nodiscard]] Figure undecided_gap_figure(const Request& request);

/// Rechecks of the neediest query of a cycle, against the list.
[[nodiscard]] Figure rechecks_figure(const Request& request);

/// Certified and plain clearance less the true distance.
[[nodiscard]] Figure clearance_error_figure(const Request& request);

/// Verdicts that differ when the same pair is handed over in another order or frame.
[[nodiscard]] Figure flips_figure(const Request& request);

}  // namespace axg::chart
