// SPDX-License-Identifier: Apache-2.0
// The modal state of the interpreter between blocks. Codes are ten times the number, as in
// gcode_words.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "hil_replay/program.hpp"

namespace axg {

struct GcodeState {
    std::int32_t motion = 800;  // nothing until a program says so
    std::int32_t plane = 170;
    bool is_inch = false;
    bool is_incremental = false;
    bool has_absolute_centers = false;
    bool is_inverse_time = false;
    double feed = 0;               // as programmed, per minute
    bool is_feed_unknown = false;  // a refused block may have set it
    double feed_scale = 1;         // 25.4 where inch was on when F was read
    bool is_exact = false;         // G61, G61.1
    double blend_mm = -1;          // G64 P; negative: the planner's default
    std::size_t work_offset = 0;
    double tool_length_mm = 0;                   // of G43, 0 after G49
    std::optional<std::uint16_t> selected_tool;  // T, until M6 puts it into the spindle
    std::uint16_t spindle_tool = 0;
    AxisPositions position{};  // machine coordinates
    bool has_ended = false;
};

}  // namespace axg
