// SPDX-License-Identifier: Apache-2.0
// The modal state of the interpreter between blocks. Codes are ten times the number, as in
// gcode_words.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/sincos.hpp"
#include "hil_replay/gcode/gcode_biarc.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"

namespace axg {

// LinuxCNC 2.9, posemath.h, CART_FUZZ: an axis that moves less, mm or degrees, does not move, and
// an arc with nearer ends is a full turn. Two sums for one place differ by less.
inline constexpr double kSamePlaceMm = 1e-8, kSamePlaceRad = 1e-8 * kPi / 180;

/// Words of a canned cycle that apply to the next one of its kind, in units of the program. The
/// height of G98 is the height before the first cycle of a row.
struct CycleState {
    double r = 0, bottom = 0, dwell_s = 0, peck = 0;
    double first_height_mm = 0;  // machine coordinates
    bool is_in_row = false;
};

/// What G5 leaves to the next G5, and G5.2 to G5.3, in the program's unit and coordinates.
struct SplineState {
    bool has_tangent = false;  // the block before was G5
    double next_i = 0, next_j = 0;
    bool is_open = false;     // between G5.2 and G5.3
    bool is_refused = false;  // for a fault that was reported
    std::uint32_t order = 0;  // L; 0: not stated
    std::vector<SplinePoint> points;
    AxisPositions end{};  // the last point, in machine coordinates
};

struct GcodeState {
    std::int32_t motion = 800;  // no motion mode until the program sets one
    std::int32_t plane = 170;
    bool is_inch = false;
    bool is_unit_of_start = true;  // no G20 or G21 yet
    bool is_incremental = false;
    bool has_absolute_centers = false;
    bool is_inverse_time = false, is_per_revolution = false;
    double feed = 0;                     // as programmed, per minute or per revolution
    double spindle_rev_min = 0;          // S
    bool has_surface_speed = false;      // G96: S is no speed of the spindle
    bool is_feed_unknown = false;        // a refused block may have set it
    double feed_scale = 1;               // 25.4 if F was read in inch
    bool is_feed_in_start_unit = false;  // F was read before any G20 or G21
    bool is_exact = false;               // G61, G61.1
    double blend_mm = -1;                // G64 P; negative: the planner's default
    std::size_t work_offset = 0;
    std::array<AxisPositions, kWorkOffsets> work_offsets{};  // mm or rad
    std::array<double, kWorkOffsets> rotations_rad{};        // G10 L2 R: of X and Y about Z
    AxisPositions local_offset{}, kept_local_offset{};       // G52, G92; the second is for G92.3
    bool retracts_to_r = true;                               // G99, LinuxCNC's default; false: G98
    CycleState cycle;
    SplineState spline;
    AxisPositions tool_offset{};  // of G43 or G43.1, 0 after G49; mm or rad
    // Tool centre point control: by G43.4 until another word of its group, by M428 until M429.
    bool has_length_control = false, has_kinematics_control = false;
    std::uint32_t control = kNoIndex;            // Program::controls, while it is on
    std::optional<std::uint16_t> selected_tool;  // T, until M6 puts it into the spindle
    std::uint16_t spindle_tool = 0;
    // Target of the last move: axes without a word remain there. Machine coordinates, or under tool
    // centre point control the commanded position.
    AxisPositions position{};
    // The actual position in the same coordinates while it differs: from a change of the tool
    // offset under control to the next move.
    std::optional<AxisPositions> standing_at;
    // Axes that a probe moved and no absolute word since: where they are is the touched part's.
    std::array<bool, kAxesMax> is_probed{};
    // Where its last absolute word left each axis, and the offset then: LinuxCNC has that very
    // number, and not a sum that differs by rounding.
    AxisPositions word_position{}, word_offset{};
    bool has_ended = false;
};

}  // namespace axg
