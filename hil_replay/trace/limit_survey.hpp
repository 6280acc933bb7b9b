// SPDX-License-Identifier: Apache-2.0
// Evidence of a trace about each declared limit: the least speed, acceleration and
// jerk that explain them, less the errors. mm and s, or rad and s.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/machine/machine.hpp"
#include "core/reach/limit_evidence.hpp"

namespace axg {

/// The largest of one figure in free motion.
struct LimitPeak {
    double measured = 0;
    std::int64_t time_us = 0;         // arrival of the sample that showed it first
    std::uint64_t samples_above = 0;  // with more than is declared
};

struct AxisLimitSurvey {
    LimitPeak speed, acceleration, jerk;
    double seen_speed = 0, seen_acceleration = 0;  // errors not subtracted
    std::uint64_t stops = 0;                       // of the board's own, harder than free motion
    double softest_stop = 0;     // the deceleration of the softest of them; 0: there was none
    double hardest_in_stop = 0;  // of the stop that is on
};

class LimitSurvey {
  public:
    explicit LimitSurvey(const Machine& machine);

    /// @param is_first  nothing before it counts: the receiver began anew
    void add(const AxisSnapshot& snapshot, bool is_first) noexcept;

    [[nodiscard]] const std::vector<AxisLimitSurvey>& axes() const noexcept { return axes_; }

  private:
    void add_axis(std::uint32_t axis, const AxisSnapshot& snapshot) noexcept;

    LimitRules rules_;
    LimitWatch watch_;
    MotionHistory history_;
    std::vector<AxisLimitSurvey> axes_;  // [Machine::axes]
};

/// Values for the machine file; 0: the trace does not show one.
struct ProposedLimits {
    double speed = 0, acceleration = 0, jerk = 0, stopping = 0;
    bool is_jerk_unlimited = false;  // the acceleration is full within one stride
};

/// A tenth above the largest value in the trace, errors not subtracted: a limit must not be below
/// the motion of the axis. Rounded up to two digits in the unit of the machine file. A stopping
/// deceleration: a tenth below the softest stop, rounded down.
/// @param stride_s  time between two points that are compared
[[nodiscard]] ProposedLimits proposed_limits(const Axis& axis, const AxisLimitSurvey& seen,
                                             double stride_s) noexcept;

}  // namespace axg
