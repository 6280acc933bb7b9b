// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_words.hpp"

namespace axg {
namespace {

using enum ModalGroup;
using enum WordSupport;

constexpr std::string_view kByHand = "boring that an operator ends by hand";
constexpr std::string_view kProbe = "probing, read to its end";
constexpr std::string_view kHomeWrite = "stores a position; use G53 G0";

constexpr std::string_view kLathe = "roughing cycle of a lathe";

constexpr GcodeWordRule kRules[] = {
    {'G', 0, motion, read, "rapid"},
    {'G', 10, motion, read, "line at feed"},
    {'G', 20, motion, read, "arc or helix, clockwise"},
    {'G', 30, motion, read, "arc or helix, counter-clockwise"},
    {'G', 40, non_modal, read, "dwell, P seconds"},
    {'G', 50, motion, read, "cubic spline"},
    {'G', 51, motion, read, "quadratic spline"},
    {'G', 52, motion, read, "control point of a NURBS"},
    {'G', 53, non_modal, read, "end of a NURBS: moves along it"},
    {'G', 62, motion, refused, "NURBS; post it as lines or arcs"},
    {'G', 70, count, refused, "lathe diameter mode"},
    {'G', 80, count, no_motion, "lathe radius mode: nothing to change"},
    {'G', 100, non_modal, read, "L2, L20: writes a work offset"},
    {'G', 170, plane, read, "plane XY"},
    {'G', 180, plane, read, "plane ZX"},
    {'G', 190, plane, read, "plane YZ"},
    {'G', 171, plane, refused, "plane UV"},
    {'G', 181, plane, refused, "plane WU"},
    {'G', 191, plane, refused, "plane VW"},
    {'G', 200, units, read, "inch"},
    {'G', 210, units, read, "mm"},
    {'G', 280, non_modal, read, "to the stored position"},
    {'G', 281, non_modal, refused, kHomeWrite},
    {'G', 300, non_modal, read, "to the second stored position"},
    {'G', 301, non_modal, refused, kHomeWrite},
    {'G', 330, motion, read, "line at K each revolution of the spindle, at S"},
    {'G', 331, motion, read, "rigid tapping: there and back, turning round at the end"},
    {'G', 382, motion, read, kProbe},
    {'G', 383, motion, read, kProbe},
    {'G', 384, motion, read, kProbe},
    {'G', 385, motion, read, kProbe},
    {'G', 400, cutter, read, "cutter compensation off"},
    {'G', 410, cutter, read, "tool left of the contour, diameter from the machine file"},
    {'G', 411, cutter, read, "tool left of the contour, diameter D"},
    {'G', 420, cutter, read, "tool right of the contour, diameter from the machine file"},
    {'G', 421, cutter, read, "tool right of the contour, diameter D"},
    {'G', 430, tool_length, read, "tool length from the machine file"},
    {'G', 431, tool_length, read, "tool offset by words"},
    {'G', 432, tool_length, refused, "sum of tool offsets"},
    {'G', 434, tool_length, read, "tool length, and tool centre point control on"},
    {'G', 490, tool_length, read, "no tool length"},
    {'G', 520, non_modal, read, "local offset"},
    {'G', 530, non_modal, read, "this block in machine coordinates"},
    {'G', 540, offsets, read, "work offset 1"},
    {'G', 550, offsets, read, "work offset 2"},
    {'G', 560, offsets, read, "work offset 3"},
    {'G', 570, offsets, read, "work offset 4"},
    {'G', 580, offsets, read, "work offset 5"},
    {'G', 590, offsets, read, "work offset 6"},
    {'G', 591, offsets, read, "work offset 7"},
    {'G', 592, offsets, read, "work offset 8"},
    {'G', 593, offsets, read, "work offset 9"},
    {'G', 610, path, read, "exact path: every corner comes to rest"},
    {'G', 611, path, read, "exact stop: every block comes to rest"},
    {'G', 640, path, read, "path blending, tolerance P"},
    {'G', 700, motion, refused, kLathe},
    {'G', 710, motion, refused, kLathe},
    {'G', 711, motion, refused, kLathe},
    {'G', 712, motion, refused, kLathe},
    {'G', 720, motion, refused, kLathe},
    {'G', 721, motion, refused, kLathe},
    {'G', 722, motion, refused, kLathe},
    {'G', 730, motion, read, "drilling with chip breaking"},
    {'G', 740, motion, refused, "left-hand tapping; G84 moves alike"},
    {'G', 760, motion, refused, "threading cycle of a lathe"},
    {'G', 800, motion, read, "motion mode off"},
    {'G', 810, motion, read, "drilling"},
    {'G', 820, motion, read, "drilling with dwell"},
    {'G', 830, motion, read, "peck drilling"},
    {'G', 840, motion, read, "tapping, floating chuck"},
    {'G', 850, motion, read, "boring, out at feed"},
    {'G', 860, motion, read, "boring, spindle stop, out at rapid"},
    {'G', 870, motion, refused, kByHand},
    {'G', 880, motion, refused, kByHand},
    {'G', 890, motion, read, "boring with dwell, out at feed"},
    {'G', 900, distance, read, "absolute"},
    {'G', 901, arc_distance, read, "arc centres absolute"},
    {'G', 910, distance, read, "incremental"},
    {'G', 911, arc_distance, read, "arc centres incremental, the default"},
    {'G', 920, non_modal, read, "offset: the axes are where the words say"},
    {'G', 921, non_modal, read, "G92's offset to zero, and forgotten"},
    {'G', 922, non_modal, read, "G92's offset to zero, but kept"},
    {'G', 923, non_modal, read, "G92's kept offset again"},
    {'G', 930, feed_mode, read, "inverse time"},
    {'G', 940, feed_mode, read, "units per minute"},
    {'G', 950, feed_mode, read, "units per revolution of the spindle, at S"},
    {'G', 960, spindle_mode, no_motion, "constant surface speed; refused with G95 and G33"},
    {'G', 970, spindle_mode, no_motion, "constant spindle speed"},
    {'G', 980, retract, read, "cycles end at the height before the first of them"},
    {'G', 990, retract, read, "cycles end at R"},
    {'M', 0, stop, read, "pause: the axes come to rest, then go on"},
    {'M', 10, stop, read, "optional pause, treated as M0"},
    {'M', 20, stop, read, "end of program"},
    {'M', 30, spindle, no_motion, "spindle on"},
    {'M', 40, spindle, no_motion, "spindle on, counter-clockwise"},
    {'M', 50, spindle, no_motion, "spindle off"},
    {'M', 60, tool_change, read, "the tool of the last T"},
    {'M', 70, coolant, no_motion, "mist"},
    {'M', 80, coolant, no_motion, "flood"},
    {'M', 90, coolant, no_motion, "coolant off"},
    {'M', 190, spindle, no_motion, "spindle orientation"},
    {'M', 300, stop, read, "end of program"},
    {'M', 480, overrides, no_motion, "overrides on: 100 % is simulated"},
    {'M', 490, overrides, no_motion, "overrides off"},
    {'M', 500, overrides, no_motion, "feed override: 100 % is simulated"},
    {'M', 510, overrides, no_motion, "spindle override"},
    {'M', 520, overrides, refused, "adaptive feed: unknown speed"},
    {'M', 530, overrides, no_motion, "feed stop: nobody presses it"},
    {'M', 600, stop, refused, "pallet change"},
    {'M', 610, count, refused, "sets the tool number; write Tn M6"},
    {'M', 620, outputs, no_motion, "digital output on, with motion"},
    {'M', 630, outputs, no_motion, "digital output off, with motion"},
    {'M', 640, outputs, no_motion, "digital output on"},
    {'M', 650, outputs, no_motion, "digital output off"},
    {'M', 660, outputs, read, "waits for an input: the axes come to rest"},
    {'M', 670, outputs, no_motion, "analog output, with motion"},
    {'M', 680, outputs, no_motion, "analog output"},
    {'M', 700, saving, read, "saves the modes"},
    {'M', 710, saving, read, "forgets saved modes"},
    {'M', 720, saving, read, "restores the modes"},
    {'M', 730, saving, read, "saves them until the return"},
    {'M', 980, count, read, "calls the lines from O P to M99, L times"},
    {'M', 990, count, read, "ends a call by M98"},
    {'M', 4280, kinematics, read, "tool centre point control on"},
    {'M', 4290, kinematics, read, "tool centre point control off"},
};

}  // namespace

std::span<const GcodeWordRule> gcode_word_rules() {
    return kRules;
}

const GcodeWordRule* find_gcode_word(char letter, std::int32_t code) {
    for (const GcodeWordRule& rule : kRules) {
        if (rule.letter == letter && rule.code == code) {
            return &rule;
        }
    }
    return nullptr;
}

}  // namespace axg
