// SPDX-License-Identifier: Apache-2.0
// Stores the true path of a drive for judging afterwards: a bus leaves no time for that. Five axes
// need 56 bytes an instant.
#pragma once

#include <cstdint>
#include <deque>
#include <span>

#include "hil_replay/board/axis_motion.hpp"
#include "hil_replay/drive/path_judge.hpp"

namespace axg {

class PathRecord {
  public:
    /// Call in order of time, with the same axes each time.
    void add(std::int64_t time_us, std::span<const AxisMotion> axes, std::uint16_t tool);
    /// Passes every instant to `judge`, in order, up to the first contact.
    void show(PathJudge& judge) const;

  private:
    struct Instant {
        std::int64_t time_us = 0;
        std::uint16_t tool = 0;
    };
    std::deque<Instant> instants_;  // deques: growth copies no elements
    std::deque<double> positions_;  // [instants][axes]
};

}  // namespace axg
