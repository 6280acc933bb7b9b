// SPDX-License-Identifier: Apache-2.0
// The distance along a run as a function of time, while the axes obey a share of their largest
// speeds that may change at any step. The plan of ProfileClock bounds the speed, which follows the
// share with the accelerations of that plan. So the proofs of docs/theory/motion.md about a profile
// hold.
#pragma once

#include <cstddef>
#include <vector>

#include "hil_replay/motion/motion_plan.hpp"

namespace axg {

class CappedClock {
  public:
    /// @param cells, rapids  results of plan_run and plan_rapid; they must outlive the run
    void begin(const std::vector<Cell>* cells, const std::vector<RapidCell>* rapids) noexcept;
    /// Distance after another step of kMotionStepS, mm, before averaging; constant after the end.
    /// @param speed_share  of each axis' largest speed; 0: brakes to rest
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
