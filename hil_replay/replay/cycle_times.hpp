// SPDX-License-Identifier: Apache-2.0
// Summary of the times of many cycles: percentiles, the slowest, and 3/N, the share
// that may still be slower than all of them (95 %). us.
#pragma once

#include <vector>

namespace axg {

struct CyclePercentiles {
    double p50_us = 0, p99_us = 0, p999_us = 0, max_us = 0;
    double three_over_n = 0;
};

/// Precondition: at least one cycle.
[[nodiscard]] CyclePercentiles percentiles_of(std::vector<double> cycle_us);

}  // namespace axg
