// SPDX-License-Identifier: Apache-2.0
// Each axis of a machine moved a little, forward and back, for the page of `axguard check`: a
// person sees whether the model moves as the machine does.
#pragma once

#include <vector>

#include "hil_replay/page/run_page.hpp"

namespace axg {

struct AxisJog {
    std::uint32_t axis = 0;
    double distance = 0;  // mm or rad; negative where there is no travel forward
    double begin_s = 0, end_s = 0;
};

/// From the position nearest to all axes at 0 within the travel, one axis after the other.
[[nodiscard]] std::vector<AxisJog> plan_jogs(const Machine& machine);

/// The samples of these jogs, with the clearances at each.
void record_jogs(const Machine& machine, const std::vector<AxisJog>& jogs, PageRecorder& page);

}  // namespace axg
