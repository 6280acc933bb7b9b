// SPDX-License-Identifier: Apache-2.0
// Checks that a move remains inside the travel of every axis, with the outermost points of an arc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hil_replay/motion/program.hpp"

namespace axg {

inline constexpr double kTravelSlack = 1e-9;  // mm or rad: rounding of unit conversions

/// One axis that leaves its travel in one move.
struct TravelExcess {
    std::uint32_t axis = 0;
    bool is_low = false;  // beyond the lower end
    double value = 0;     // farthest position of the move, mm or rad
};

/// Every axis that leaves its travel. The move before has checked an axis at rest during a line.
[[nodiscard]] std::vector<TravelExcess> check_travel(const Machine& machine,
                                                     const AxisPositions& from, const Move& move);

/// The same under tool centre point control. X Y Z move along curves; checks one point of them per
/// quarter of a degree that rotary axes turn. At 300 mm from the pivot the error is 1 um.
/// @param is_singular  out: somewhere X, Y and Z do not move the tip in all directions
[[nodiscard]] std::vector<TravelExcess> check_controlled_travel(const Machine& machine,
                                                                const TipControl& control,
                                                                const AxisPositions& from,
                                                                const Move& move,
                                                                bool& is_singular);

/// "out of travel: goes to 301 mm, the upper end is 300 mm (machine coordinates)"
[[nodiscard]] std::string describe_excess(const Machine& machine, const TravelExcess& excess);

/// Collects the moves that leave the travel. With a wrong offset every block may: the first move
/// per axis and end is a fault, which also reports the number of further moves and the farthest.
class TravelWatch {
  public:
    /// @param from  the start of `move`, in the coordinates of its target
    void check(const Machine& machine, const Program& program, const AxisPositions& from,
               const Move& move, std::vector<ProgramFault>& faults);

  private:
    struct Seen {
        TravelExcess first, farthest;
        std::size_t fault = 0;   // index in the faults
        std::size_t more = 0;    // moves after the first
        std::uint32_t line = 0;  // of the farthest
    };
    std::vector<Seen> seen_;  // at most two per axis
    bool was_singular_ = false;
};

}  // namespace axg
