// SPDX-License-Identifier: Apache-2.0
// What a benchmark says of the times of many cycles: percentiles, the slowest, and 3/N, the share
// that may still be slower than all of them (95 %). us.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace axg {

/// p50, p99, p999, max and three_over_n. Precondition: at least one cycle.
[[nodiscard]] nlohmann::ordered_json describe_cycles(std::vector<double> cycle_us);

}  // namespace axg
