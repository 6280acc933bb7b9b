// SPDX-License-Identifier: Apache-2.0
// Whether a move stays inside the travel of every axis, its arc's outermost points included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/motion/program.hpp"

namespace axg {

inline constexpr double kTravelSlack = 1e-9;  // mm or rad: rounding of unit conversions

/// One axis that one move takes out of its travel.
struct TravelExcess {
    std::uint32_t axis = 0;
    bool is_low = false;  // beyond the lower end
    double value = 0;     // how far the move goes, mm or rad
};

/// Every axis that leaves its travel; an axis that does not move was judged by the move before.
[[nodiscard]] std::vector<TravelExcess> check_travel(const Machine& machine,
                                                     const AxisPositions& from, const Move& move);

/// The same under tool centre point control. X Y Z go along curves, of which a point is judged for
/// every quarter of a degree that rotary axes turn: one 300 mm away is met to 1 um.
/// @param is_singular  out: somewhere X, Y and Z do not move the tip in all directions
[[nodiscard]] std::vector<TravelExcess> check_controlled_travel(const Machine& machine,
                                                                const TipControl& control,
                                                                const AxisPositions& from,
                                                                const Move& move,
                                                                bool& is_singular);

/// "out of travel: goes to 301 mm, the upper end is 300 mm (machine coordinates)"
[[nodiscard]] std::string describe_excess(const Machine& machine, const TravelExcess& excess);

/// Collects what leaves the travel in a program. A zero that lies elsewhere takes every block out:
/// the first move of each axis and end is a fault, the others are counted in it, with the farthest.
class TravelWatch {
  public:
    /// @param from  what `move` starts from, in the coordinates of its target
    void check(const Machine& machine, const Program& program, const AxisPositions& from,
               const Move& move, std::vector<ProgramFault>& faults);

  private:
    struct Seen {
        TravelExcess first, farthest;
        std::size_t fault = 0;   // its place among the faults
        std::size_t more = 0;    // moves after the first
        std::uint32_t line = 0;  // of the farthest
    };
    std::vector<Seen> seen_;  // at most two an axis
    bool was_singular_ = false;
};

}  // namespace axg
