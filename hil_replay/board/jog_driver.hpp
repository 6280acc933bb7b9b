// SPDX-License-Identifier: Apache-2.0
// A jog: moves one axis in one direction by a distance, at the speed and acceleration that the
// machine file allows a jog.
#pragma once

#include "core/machine/machine.hpp"
#include "core/reach/jog.hpp"
#include "hil_replay/board/motion_board.hpp"

namespace axg {

struct JogMotionPlan {
    JogMove move;
    double distance = 0;  // mm or rad; it ends there or a little before
    double tick_s = 1e-3;
    std::uint16_t tool = 0;  // in the spindle; 0: Machine::first_tool
};

/// Is over when the axis rests. `machine` must outlive the motion.
[[nodiscard]] CommandedMotion make_jog(const Machine& machine, const JogMotionPlan& plan);

}  // namespace axg
