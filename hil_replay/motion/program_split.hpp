// SPDX-License-Identifier: Apache-2.0
// One axis after the other, in Machine::axes order, as the seed paper's simulator moves a machine.
#pragma once

#include "hil_replay/motion/program.hpp"

namespace axg {

/// Every line and arc becomes one line an axis, each at rest at its end; arcs keep their end point
/// only. Feeds per minute count for each axis by itself; an inverse-time feed is shared so that the
/// whole move still takes its time.
[[nodiscard]] Program split_by_axis(const Program& program, const Machine& machine);

}  // namespace axg
