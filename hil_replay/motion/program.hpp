// SPDX-License-Identifier: Apache-2.0
// A program as canonical moves: every target is an axis position in machine coordinates, mm or rad,
// or under tool centre point control a position of the tip. The interpreter has resolved dialect,
// units and offsets; the motion planner uses the moves without change.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "hil_replay/motion/tip_control.hpp"

namespace axg {

enum class MoveKind : std::uint8_t {
    line,
    arc,
    dwell,
    tool_change,
    coordinates,  // no axis moves: `target` is the present position in the coordinates of the
                  // following moves
};

enum class FeedKind : std::uint8_t {
    rapid,       // as fast as the axes and the cap allow
    per_minute,  // mm/min along X Y Z (else U V W), deg/min when only rotary axes move
    inverse,     // the duration of the whole move is 1/feed minutes
};

/// A circle in the plane of two linear axes; every other axis of the move follows linearly with the
/// angle.
struct Arc {
    std::uint32_t first = kNoIndex,
                  second = kNoIndex;                   // axes; counter-clockwise is first to second
    double center_first_mm = 0, center_second_mm = 0;  // machine coordinates
    double radius_start_mm = 0, radius_end_mm = 0;     // differ by the dialect's tolerance at most
    double start_rad = 0;                              // angle of the start point
    double sweep_rad = 0;                              // signed; more than a turn for P turns
};

struct Move {
    MoveKind kind = MoveKind::line;
    FeedKind feed_kind = FeedKind::rapid;
    bool is_exact = false;   // stops at its end (G61, G28's way point)
    std::uint16_t tool = 0;  // tool_change: number of the tool now in the spindle
    std::uint32_t line = 0;  // of the program file
    double feed = 0;         // mm/min, deg/min or 1/min, by feed_kind
    double blend_mm =
        -1;  // path tolerance of the corner at its end; negative: the planner's default
    double dwell_s = 0;
    // In Program::controls; `target` and `arc` are then commanded positions (tip_control.hpp).
    std::uint32_t control = kNoIndex;
    AxisPositions target{};
    Arc arc;
};

/// One fault of a program. Prints as `part.ngc:12: G81: not supported (...)`.
struct ProgramFault {
    std::uint32_t line = 0;
    std::string word;
    std::string message;
};

struct Program {
    AxisPositions start{};
    std::uint16_t start_tool = 0;
    std::vector<Move> moves;
    std::vector<TipControl> controls;  // one for each tool offset
};

/// A feed override multiplies programmed feeds, not rapids; G93's durations shrink by it.
inline void scale_feeds(Program& program, int percent) {
    for (Move& move : program.moves) {
        if (move.feed_kind != FeedKind::rapid) {
            move.feed *= percent / 100.0;
        }
    }
}

}  // namespace axg
