// SPDX-License-Identifier: Apache-2.0
// The distance along a run as a function of time, where each axis keeps to a share of its largest
// speed that may change at any step. A piece of the path allows the speed at which every axis keeps
// its share. That is in force from as long as is averaged before the piece to as long behind it,
// and the speed brakes towards it with the least acceleration on the way. What an axis needs is, of
// every piece up to where the path could stop, the share that it has there if braked for from now
// on. Source: docs/theory/motion.md.
#pragma once

#include <cstddef>
#include <vector>

#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/motion/motion_plan.hpp"

namespace axg {

class PlannedClock {
  public:
    /// `run` and `cells`, as plan_run left them, must outlive the run.
    void begin(const Run* run, const MotionLimits& limits, const std::vector<Cell>* cells) noexcept;
    /// Distance after another step of kMotionStepS, mm, before averaging; stays at the end.
    double step(AxisShares& shares) noexcept;
    [[nodiscard]] bool is_at_end() const noexcept { return is_at_end_; }

  private:
    /// A piece of the path that the axes come to, or have not left for as long as is averaged.
    struct Place {
        double start_mm, end_mm, most;  // most: path speed that is wanted in it
        double acceleration;            // on the way there
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
