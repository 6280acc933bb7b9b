// SPDX-License-Identifier: Apache-2.0
// The distance along a run as a function of time, while each axis obeys a share of its largest
// speed that may change at any step. A piece of the path allows the speed at which every axis obeys
// its share. This limit applies from one averaging time before the piece until one after it; the
// speed brakes to it with the least acceleration on the way. The need of an axis is its largest
// share in all pieces up to where the path could stop, if the path brakes for them from now on.
// Source: docs/theory/motion.md.
#pragma once

#include <cstddef>
#include <vector>

#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/motion/motion_plan.hpp"

namespace axg {

class PlannedClock {
  public:
    /// @param run, cells  `cells` from plan_run; both must outlive the run
    void begin(const Run* run, const MotionLimits& limits, const std::vector<Cell>* cells) noexcept;
    /// Distance after another step of kMotionStepS, mm, before averaging; constant after the end.
    double step(AxisShares& shares) noexcept;
    [[nodiscard]] bool is_at_end() const noexcept { return is_at_end_; }

  private:
    /// A piece of the path ahead, or one that the averaging window still contains.
    struct Place {
        double start_mm, end_mm, most;  // most: largest path speed that the shares allow in it
        double acceleration;            // the least on the way to it
    };
    template <class Visit>
    void visit_ahead(const AxisShares& shares, Visit&& visit) noexcept;
    [[nodiscard]] double speed_within(const AxisShares& shares, double speed) noexcept;
    void note_needs(AxisShares& shares) noexcept;

    const Run* run_ = nullptr;
    const std::vector<Cell>* cells_ = nullptr;
    std::uint32_t axes_ = 0;
    double window_s_ = 0;
    std::size_t cell_ = 0, piece_ = 0;
    double at_mm_ = 0, speed_ = 0, total_mm_ = 0;
    bool is_at_end_ = false;
};

}  // namespace axg
