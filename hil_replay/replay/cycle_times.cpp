// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/cycle_times.hpp"

#include <algorithm>
#include <cmath>

namespace axg {

CyclePercentiles percentiles_of(std::vector<double> cycle_us) {
    std::sort(cycle_us.begin(), cycle_us.end());
    const auto at = [&cycle_us](double share) {
        const auto last = static_cast<double>(cycle_us.size() - 1);
        return cycle_us[static_cast<std::size_t>(std::ceil(share * last))];
    };
    return {at(0.5), at(0.99), at(0.999), at(1.0), 3.0 / static_cast<double>(cycle_us.size())};
}

}  // namespace axg
