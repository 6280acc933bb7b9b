// SPDX-License-Identifier: Apache-2.0
// The figures of `axguard-lab chart`. Each is a function of its request: the same seed gives the
// same counts, but other times. On another machine the C library may round a drawn gap differently.
#pragma once

#include <vector>

#include "hil_replay/lab/chart/figure.hpp"

namespace axg::chart {

/// One measurement, three figures: speed against accuracy, missed contacts, pairs not separated.
[[nodiscard]] std::vector<Figure> method_figures(const Request& request);

/// Time of whole cycles against early stops, compared with records of other libraries.
[[nodiscard]] Figure cycle_figure(const Request& request);

/// Coarser models: time against early stops, from the records of two machines.
[[nodiscard]] Figure model_figure(const Request& request);

/// Undecided rate of the certified methods against the true gap.
[[nodiscard]] Figure undecided_gap_figure(const Request& request);

/// Rechecks of the query that needs most in a cycle, against the capacity of the list.
[[nodiscard]] Figure rechecks_figure(const Request& request);

/// Certified and plain clearance less the true distance.
[[nodiscard]] Figure clearance_error_figure(const Request& request);

/// Verdicts that differ when a method gets the same pair in another order or frame.
[[nodiscard]] Figure flips_figure(const Request& request);

}  // namespace axg::chart
