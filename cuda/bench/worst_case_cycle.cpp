// SPDX-License-Identifier: Apache-2.0
// Cycles to measure; their description needs no device.
#include "cuda/bench/measure_worst_case.hpp"

namespace axg {

WorstCaseCycle batch_cycle(const Capacities& capacities, std::uint32_t launches) {
    WorstCaseCycle cycle;
    cycle.calls = {{.capacities = capacities, .times = launches}};
    return cycle;
}

std::uint32_t launches_of(const WorstCaseCycle& cycle) noexcept {
    std::uint32_t launches = 0;
    for (const WorstCaseCall& call : cycle.calls) {
        launches += call.times;
    }
    return launches;
}

}  // namespace axg
