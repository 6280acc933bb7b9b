// SPDX-License-Identifier: Apache-2.0
// The true path of a drive, for a judge that comes afterwards: a bus leaves no time for judging.
// Five axes take 56 bytes an instant.
#pragma once

#include <cstdint>
#include <deque>
#include <span>

#include "hil_replay/board/axis_motion.hpp"
#include "hil_replay/drive/path_judge.hpp"

namespace axg {

class PathRecord {
  public:
    /// In order of time, the same axes each time.
    void add(std::int64_t time_us, std::span<const AxisMotion> axes, std::uint16_t tool);
    /// Every instant, in order, up to the first contact.
    void show(PathJudge& judge) const;

  private:
    struct Instant {
        std::int64_t time_us = 0;
        std::uint16_t tool = 0;
    };
    std::deque<Instant> instants_;  // deques: nothing is copied while they grow
    std::deque<double> positions_;  // [instants][axes]
};

}  // namespace axg
