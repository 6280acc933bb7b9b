// SPDX-License-Identifier: Apache-2.0
// The distance along a run as a function of time, where the axes keep to a share of their largest
// speeds that may change at any step: ProfileClock's plan is the most, and the speed follows the
// share with the accelerations of that plan. So what docs/theory/motion.md proves of a profile
// holds.
#pragma once

#include <cstddef>
#include <vector>

#include "hil_replay/motion/motion_plan.hpp"

namespace axg {

class CappedClock {
  public:
    /// Both as plan_run and plan_rapid left them; they must outlive the run.
    void begin(const std::vector<Cell>* cells, const std::vector<RapidCell>* rapids) noexcept;
    /// Distance after another step of kMotionStepS, mm, before averaging; stays at the end.
    /// @param speed_share  of each axis' largest speed; 0: it comes to rest, and stands
    double step(double speed_share) noexcept;
    [[nodiscard]] bool is_at_end() const noexcept { return is_at_end_; }

  private:
    const std::vector<Cell>* cells_ = nullptr;
    const std::vector<RapidCell>* rapids_ = nullptr;
    std::size_t cell_ = 0, rapid_ = 0;
    double at_mm_ = 0, speed_ = 0, total_mm_ = 0;
    bool is_at_end_ = false;
};

}  // namespace axg
