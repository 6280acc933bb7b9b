// SPDX-License-Identifier: Apache-2.0
// Converts the words of G2 and G3 to a circle: centre, radii and swept angle, with LinuxCNC's
// tolerances.
#pragma once

#include <string>

namespace axg {

/// In the plane's own two coordinates, mm. Exactly one of the two forms is given.
struct ArcWords {
    double start_first = 0, start_second = 0;
    double end_first = 0, end_second = 0;
    bool has_radius = false;
    double radius = 0;                           // R form: negative for the longer arc
    double center_first = 0, center_second = 0;  // IJK form, absolute
    bool is_clockwise = false;
    int turns = 1;
    double tolerance_mm = 0;  // of the radii, by the program's unit
};

struct ArcShape {
    double center_first = 0, center_second = 0;
    double radius_start = 0, radius_end = 0;
    double start_rad = 0, sweep_rad = 0;
    std::string fault;  // empty: usable
};

/// Source of the rules: LinuxCNC 2.9, interp_arc.cc. Radii that differ by more than 100 times the
/// tolerance, or by more than it and by 0.1 %, are an error; R may be too short by 0.00127 mm.
[[nodiscard]] ArcShape solve_arc(const ArcWords& words);

}  // namespace axg
