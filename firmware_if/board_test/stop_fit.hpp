// SPDX-License-Identifier: Apache-2.0
// How far an axis may get in a stop, and which figures of the machine file the stops of a board
// fit: from positions alone, without a derivative. mm and s, or rad and s.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace axg {

/// A board's promise about a stop: after the reaction at least this deceleration, reached with at
/// least this jerk (kNoJerkLimit: at once).
struct StopFigures {
    double reaction_s = 0, deceleration = 0, jerk = 0;
};

/// The longest way of an axis that was at `speed` when the stop was due, `seconds` later.
[[nodiscard]] double longest_travel(const StopFigures& figures, double speed,
                                    double seconds) noexcept;

/// One axis in one stop, from the instant at which the stop was due.
struct AxisStop {
    struct Point {
        double seconds = 0, travel = 0;  // along the motion of before
    };
    std::uint32_t axis = 0;
    double speed = 0;      // before; not below the true one
    double tolerance = 0;  // of a position: resolution and stamps
    std::vector<Point> points;
};

[[nodiscard]] bool fits(const AxisStop& stop, const StopFigures& figures) noexcept;

inline constexpr double kNoReaction = 1e9;  // s: the axis did not brake

/// The shortest reaction that a stop fits; kNoReaction: none does.
[[nodiscard]] double fitted_reaction_s(const AxisStop& stop, double deceleration,
                                       double jerk) noexcept;
/// The largest deceleration, or jerk, that every stop of this axis fits with the other figures,
/// which have to fit with this one too. Empty: four times as much fits, so no stop depended on
/// it.
[[nodiscard]] std::optional<double> fitted_deceleration(std::span<const AxisStop> stops,
                                                        std::uint32_t axis,
                                                        const StopFigures& figures) noexcept;
[[nodiscard]] std::optional<double> fitted_jerk(std::span<const AxisStop> stops, std::uint32_t axis,
                                                const StopFigures& figures) noexcept;

}  // namespace axg
