// SPDX-License-Identifier: Apache-2.0
// Where the axes were a short time ago: for a board whose frames carry positions of before, as a
// pipelined or latched register makes them. mm and s, or rad and s; instants in us.
#pragma once

#include <cstdint>
#include <vector>

#include "hil_replay/board/axis_motion.hpp"

namespace axg {

/// Between two notes an axis moves at a constant jerk, but for what it changes in so short a time.
inline constexpr std::int64_t kPastPartUs = 250;

class PastMotion {
  public:
    /// @param longest_us  how far back it is asked for
    explicit PastMotion(std::int64_t longest_us);

    /// Instants that do not go back, at most kPastPartUs apart where axes move.
    void note(std::int64_t time_us, const AxisMotions& axes);
    /// Before the first note, or beyond what is kept: the oldest position that is known.
    /// Precondition: one was noted, at this instant or later.
    [[nodiscard]] double position(std::int64_t time_us, std::size_t axis) const;

  private:
    struct Note {
        std::int64_t time_us = 0;
        AxisMotions axes{};
    };
    [[nodiscard]] const Note& back(std::size_t count) const {
        return notes_[(count_ - 1 - count) % notes_.size()];
    }

    std::vector<Note> notes_;
    std::size_t count_ = 0;
};

}  // namespace axg
