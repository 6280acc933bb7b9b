// SPDX-License-Identifier: Apache-2.0
// Moves one axis after the other, in Machine::axes order, like the seed paper's simulator.
#pragma once

#include "hil_replay/motion/program.hpp"

namespace axg {

/// Replaces every line, and every arc up to its end point, by one line per moving axis, each with a
/// stop at its end. A feed per minute applies to each axis by itself; an inverse-time feed is
/// divided so that the duration of the whole move does not change.
[[nodiscard]] Program split_by_axis(const Program& program, const Machine& machine);

}  // namespace axg
