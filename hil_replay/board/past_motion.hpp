// SPDX-License-Identifier: Apache-2.0
// Positions of the axes a short time ago, for a board whose frames contain older positions, as from
// a pipelined or latched register. mm and s, or rad and s; instants in us.
#pragma once

#include <cstdint>
#include <vector>

#include "hil_replay/board/axis_motion.hpp"

namespace axg {

/// Longest time between two notes of moving axes; position() assumes a constant jerk in between.
inline constexpr std::int64_t kPastPartUs = 250;

class PastMotion {
  public:
    /// @param longest_us  largest age of a position that position() returns
    explicit PastMotion(std::int64_t longest_us);

    /// Stores the axes at an instant. Instants do not decrease, and are at most kPastPartUs apart
    /// while axes move.
    void note(std::int64_t time_us, const AxisMotions& axes);
    /// Returns the position at an instant; the oldest stored one if all notes are later.
    /// Precondition: a note exists, at this instant or later.
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
