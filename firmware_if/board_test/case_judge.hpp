// SPDX-License-Identifier: Apache-2.0
// One stop of the board as the record shows it: from which instant on each axis had to brake, and
// how far it got.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/board_test/motion_record.hpp"
#include "firmware_if/board_test/stop_fit.hpp"

namespace axg {

/// Axes at a steady speed before a stop; only those are judged.
struct SteadyAxis {
    std::uint32_t axis = 0;
    double speed = 0;  // signed, mm/s or rad/s
};

/// Longest time from the end of a permit until positions show the stop: reaction and their age.
[[nodiscard]] double seen_reaction_s(const Machine& machine) noexcept;

/// The slowest speed from which a stop shows a reaction: ten times the resolution in t_board.
[[nodiscard]] double least_speed(const Machine& machine, const MotionRecord& record,
                                 std::size_t axis) noexcept;
[[nodiscard]] std::vector<SteadyAxis> steady_axes(const Machine& machine,
                                                  const MotionRecord& record);

struct StopInstant {
    std::uint64_t sample = 0;  // at a steady speed still
    double later_s = 0;        // from its latch until the stop was due
    double stamp_s = 0;        // what that may be off
};

/// The stop of each steady axis, up to its first rest or the newest sample.
[[nodiscard]] std::vector<AxisStop> stops_of(const Machine& machine, const MotionRecord& record,
                                             const std::vector<SteadyAxis>& before,
                                             const StopInstant& instant);

/// The longest reaction of these, with the machine file's deceleration and jerk.
[[nodiscard]] double longest_reaction_s(const Machine& machine,
                                        const std::vector<AxisStop>& stops) noexcept;
/// Whether the axes still had the speed of before when the stop was due.
[[nodiscard]] bool are_steady(const std::vector<AxisStop>& stops) noexcept;
/// An axis that turned round, in words; empty: none did.
[[nodiscard]] std::string reversal_of(const Machine& machine, const std::vector<AxisStop>& stops);

/// How far an axis got beyond what these figures allow, in words, and when it first did.
struct Overshoot {
    std::string words;
    double seconds = 0;  // after the stop was due
};
[[nodiscard]] std::optional<Overshoot> overshoot_of(const Machine& machine,
                                                    const std::vector<AxisStop>& stops,
                                                    double reaction_s);

}  // namespace axg
