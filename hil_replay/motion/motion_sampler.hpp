// SPDX-License-Identifier: Apache-2.0
// A program's motion as a stream of axis positions, one every 0.1 ms; one run of the path is in
// memory at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "hil_replay/motion/capped_clock.hpp"
#include "hil_replay/motion/motion_limits.hpp"
#include "hil_replay/motion/motion_path.hpp"
#include "hil_replay/motion/motion_plan.hpp"
#include "hil_replay/motion/planned_clock.hpp"

namespace axg {

struct MotionSample {
    std::uint64_t index = 0;  // time = index * 0.1 ms
    std::uint32_t line = 0;   // of the program, 0 before its first move
    std::uint16_t tool = 0;
    bool is_moving = false;  // between the first and the last step of a run
    AxisPositions position{};
};

/// Deterministic: the same program, limits and options give the same bits.
class MotionSampler {
  public:
    MotionSampler(const Program& program, const MotionLimits& limits, const MotionOptions& options);

    /// From the next run on no axis is faster than this share of its largest speed. Reads the share
    /// at every step; the speed follows with the accelerations of the plan. 0: the axes stop.
    /// @param speed_share  must outlive the sampler
    void obey(const double* speed_share) noexcept { speed_share_ = speed_share; }
    /// The same with a separate share for each axis, which it obeys through every corner.
    void obey(AxisShares* shares) noexcept { axis_shares_ = shares; }

    /// The next sample; the first is the start pose at index 0. False after the last move's end.
    bool next(MotionSample& out);

    /// Additional steps up to the last sample because of the shares.
    [[nodiscard]] std::int64_t lost_steps() const noexcept { return lost_steps_; }

    [[nodiscard]] std::uint32_t run_count() const noexcept { return run_count_; }
    [[nodiscard]] std::uint32_t blend_count() const noexcept { return blend_count_; }

  private:
    __extension__ using Wide = __int128;

    bool begin_move();
    void begin_run();
    void step_run(MotionSample& out);
    [[nodiscard]] double step_capped();
    [[nodiscard]] bool is_capped() const noexcept {
        return speed_share_ != nullptr || axis_shares_ != nullptr;
    }

    const Program& program_;
    const MotionLimits& limits_;
    const MotionOptions& options_;
    MotionSample current_;
    bool has_started_ = false;
    std::uint32_t move_ = 0;            // next to begin
    std::uint64_t standing_steps_ = 0;  // remaining steps of a dwell
    bool is_running_ = false;
    std::uint32_t run_count_ = 0, blend_count_ = 0;

    Run run_;
    std::vector<Cell> cells_;
    std::vector<RapidCell> rapids_;
    ProfileClock clock_;
    CappedClock capped_;    // replaces `clock_` if there is a common share
    PlannedClock planned_;  // or if there is a share for each axis
    double free_mm_ = 0;    // distance of `clock_`, which then only measures the lost time
    std::int64_t lost_steps_ = 0;
    const double* speed_share_ = nullptr;
    AxisShares* axis_shares_ = nullptr;
    PieceCurve curve_;
    std::size_t piece_ = 0;
    std::vector<std::int64_t> window_;  // the last smooth_steps distances, path units
    std::size_t slot_ = 0;
    Wide window_sum_ = 0;  // exact, so the average never drifts
};

}  // namespace axg
