// SPDX-License-Identifier: Apache-2.0
// The speed along one run: bounded acceleration, at rest at both ends, slow enough around every
// piece that the motion averaged over the smoothing time obeys that piece's limits. Proof:
// docs/theory/motion.md.
#pragma once

#include <vector>

#include "hil_replay/motion/motion_path.hpp"

namespace axg {

/// A stretch of the run with one speed limit and one acceleration, entered and left at planned
/// speeds.
struct Cell {
    double start_mm = 0, length_mm = 0;
    double speed_max = 0, acceleration = 0;
    double speed_in = 0, speed_out = 0;
};

/// @param cells  out; in order along the run, covering it
void plan_run(const Run& run, const MotionLimits& limits, std::vector<Cell>& cells);

/// Up to `end_mm` no axis exceeds its largest speed if the path does not exceed `speed`, whatever
/// the programmed feed.
struct RapidCell {
    double end_mm = 0, speed = 0;
};

/// @param rapids  out; in order along the run, covering it
void plan_rapid(const Run& run, const MotionLimits& limits, std::vector<RapidCell>& rapids);

/// Duration of one cell at its planned speeds.
[[nodiscard]] double cell_seconds(const Cell& cell);

/// Distance travelled along the run as a function of time, before averaging.
class ProfileClock {
  public:
    void begin(const std::vector<Cell>* cells);
    /// Distance after another step of kMotionStepS, mm; constant after the end.
    double step() noexcept;
    [[nodiscard]] bool is_at_end() const noexcept { return is_at_end_; }

  private:
    void enter_cell() noexcept;
    bool enter_phase(int phase) noexcept;

    const std::vector<Cell>* cells_ = nullptr;
    std::size_t cell_ = 0;
    int phase_ = 0;      // 0 speeding up, 1 cruising, 2 slowing down
    double peak_ = 0;    // fastest speed inside the cell
    double time_s_ = 0;  // since the start of the phase
    double duration_s_ = 0, start_mm_ = 0, speed_ = 0, acceleration_ = 0;
    bool is_at_end_ = false;
};

}  // namespace axg
