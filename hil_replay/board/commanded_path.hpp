// SPDX-License-Identifier: Apache-2.0
// Commands of a board with a look-ahead path: computed that long before the axes follow them, and
// stored as pieces of constant jerk, so that the board can also stop along them. Shares no code
// with the guard's view of that path. mm and s, or rad and s; instants in us of the board's clock.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>

#include "core/machine/machine.hpp"
#include "hil_replay/board/axis_motion.hpp"

namespace axg {

/// State of a motion for the tick that begins now.
struct MotionTick {
    bool is_over = false;  // nothing moves any more
    std::uint16_t tool = 0;
    std::uint32_t line = 0;  // of the program; 0: of none
};

/// Sets the jerk of every axis for the next tick, and may correct the state that the last one left.
using CommandedMotion = std::function<MotionTick(std::span<AxisMotion>)>;

class CommandedPath {
  public:
    /// `machine` must outlive it. `start`: positions at rest.
    CommandedPath(const Machine& machine, std::span<const double> start, CommandedMotion motion,
                  std::int64_t tick_us);

    /// The first tick begins at this instant; until then the start is commanded.
    void begin(std::int64_t at_us);

    /// The commands at an instant, computed as far as that is needed.
    [[nodiscard]] AxisMotions at(double time_us);
    /// Tool and line commanded for an instant.
    [[nodiscard]] MotionTick tick_at(double time_us);
    /// Whether the motion is over by then.
    [[nodiscard]] bool is_over(double time_us);

    /// Returns how a stop from `begin_us` brakes the rate of the path, in 1/s2 and 1/s3, so that no
    /// axis exceeds its guaranteed deceleration and jerk on the stretch that the stop needs.
    [[nodiscard]] Brake gentlest_stop(double begin_us);

    /// Discards the commands before this instant; no later call may request them.
    void forget_before(double time_us);

  private:
    struct Piece {
        AxisMotions axes{};
        MotionTick tick{};
    };
    void compute_until(double time_us);
    [[nodiscard]] const Piece& piece_at(double time_us);
    [[nodiscard]] double fastest(std::uint32_t axis, double from_us, double to_us);

    const Machine& machine_;
    CommandedMotion motion_;
    std::int64_t tick_us_;
    std::deque<Piece> pieces_;              // one a tick
    Piece start_, end_;                     // at rest: before the first one, and after the last
    AxisMotions lead_{};                    // at the end of the last piece
    std::int64_t first_us_ = INT64_MAX;     // beginning of pieces_.front()
    std::int64_t computed_us_ = INT64_MAX;  // end of pieces_.back()
    bool is_over_ = false;
};

}  // namespace axg
