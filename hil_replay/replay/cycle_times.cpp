// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/cycle_times.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace axg {

nlohmann::ordered_json describe_cycles(std::vector<double> cycle_us) {
    std::sort(cycle_us.begin(), cycle_us.end());
    const auto at = [&cycle_us](double share) {
        const auto last = static_cast<double>(cycle_us.size() - 1);
        return cycle_us[static_cast<std::size_t>(std::ceil(share * last))];
    };
    return {{"p50", at(0.5)},
            {"p99", at(0.99)},
            {"p999", at(0.999)},
            {"max", at(1.0)},
            {"three_over_n", 3.0 / static_cast<double>(cycle_us.size())}};
}

}  // namespace axg
