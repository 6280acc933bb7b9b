// SPDX-License-Identifier: Apache-2.0
// A motion that comes to the share of its speeds that a board tells it as late as it may say: the
// largest of a while counts. It can turn into an axis on its way, and announce another tool.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/board/axis_motion.hpp"
#include "hil_replay/board/axis_shares.hpp"
#include "hil_replay/board/commanded_path.hpp"

namespace axg::test {

/// Ticks are counted from the beginning of motion.
struct MotionStory {
    std::size_t lazy_ticks = 0;
    int turn_at = -1;  // before this tick some axes do not go for their target
    std::array<bool, 3> turns{};
    int reacts_ticks = 0;  // ablation: an axis that begins to move is slowed down so much later
    int tool_changes_at = -1;
    std::uint16_t tool = 1, next_tool = 1;
};

class LazyMotion {
  public:
    /// `machine` must outlive it, and it must not be moved. Three axes.
    LazyMotion(const Machine& machine, const Approach& approach, CapPromise promise,
               const MotionStory& story)
        : approach_(approach), story_(story), told_(story.lazy_ticks + 1) {
        inner_ =
            make_approach(machine, approach_, promise == CapPromise::all_axes ? &lagged_ : nullptr,
                          promise == CapPromise::per_axis ? &lagged_shares_ : nullptr);
    }
    LazyMotion(const LazyMotion&) = delete;
    LazyMotion& operator=(const LazyMotion&) = delete;

    double share = 0;   // of a board that keeps one cap for all axes
    AxisShares shares;  // and of one that keeps caps of single ones

    MotionTick operator()(std::span<AxisMotion> axes) {
        take_largest(axes.size());
        let_react(axes);
        const std::array<AxisMotion, 3> before{axes[0], axes[1], axes[2]};
        MotionTick tick = inner_(axes);
        for (std::size_t i = 0; i < axes.size(); ++i) {
            if (story_.turns[i] && ticks_ < story_.turn_at) {
                axes[i] = before[i];
                axes[i].jerk = 0;
            }
            if (story_.reacts_ticks == 0) {
                shares.needed[i] = std::max(shares.needed[i], lagged_shares_.needed[i]);
            }
        }
        lagged_shares_.needed = {};
        const bool has_next = story_.tool_changes_at >= 0 && ticks_ >= story_.tool_changes_at;
        tick.tool = has_next ? story_.next_tool : story_.tool;
        tick.is_over = rests_long(axes);
        ++ticks_;
        return tick;
    }

  private:
    struct Told {
        double share = 0;
        std::array<double, kAxesMax> of{};
    };

    void take_largest(std::size_t axis_count) {
        told_[static_cast<std::size_t>(ticks_) % told_.size()] = {share, shares.wanted};
        lagged_ = 0;
        lagged_shares_.wanted = {};
        for (const Told& one : told_) {
            lagged_ = std::max(lagged_, one.share);
            for (std::size_t i = 0; i < axis_count; ++i) {
                lagged_shares_.wanted[i] = std::max(lagged_shares_.wanted[i], one.of[i]);
            }
        }
    }
    void let_react(std::span<const AxisMotion> axes) {
        for (std::size_t i = 0; story_.reacts_ticks > 0 && i < axes.size(); ++i) {
            moved_ticks_[i] = is_resting(axes[i]) ? 0 : moved_ticks_[i] + 1;
            if (ticks_ >= story_.turn_at && moved_ticks_[i] < story_.reacts_ticks) {
                lagged_shares_.wanted[i] = 1;
            }
        }
    }
    bool rests_long(std::span<const AxisMotion> axes) {
        bool rests = true;
        for (std::size_t i = 0; i < axes.size(); ++i) {
            rests = rests && is_resting(axes[i]) &&
                    std::abs(axes[i].position - approach_.target[i]) < 0.05;
        }
        rested_ = rests ? rested_ + 1 : 0;
        return rested_ > 20;
    }

    Approach approach_;
    MotionStory story_;
    int ticks_ = 0, rested_ = 0;
    std::array<int, 3> moved_ticks_{};
    double lagged_ = 0;
    AxisShares lagged_shares_;
    std::vector<Told> told_;
    CommandedMotion inner_;
};

}  // namespace axg::test
