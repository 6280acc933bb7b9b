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
    bool is_inch = false;  // the tolerance follows the program's unit
};

struct ArcShape {
    double center_first = 0, center_second = 0;
    double radius_start = 0, radius_end = 0;
    double start_rad = 0, sweep_rad = 0;
    std::string fault;  // empty: usable
};

/// Source of the tolerances: LinuxCNC "G2, G3 Arc Move": end radius off by more than 0.5 mm (0.05
/// in), or by more than 0.005 mm (0.0005 in) and 0.1 % of the radius, is an error; R may be too
/// short by 0.005 mm (0.0005 in).
[[nodiscard]] ArcShape solve_arc(const ArcWords& words);

}  // namespace axg
