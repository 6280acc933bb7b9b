// SPDX-License-Identifier: Apache-2.0
// Every G and M code of this reader: its modal group, and whether it is read, ignored or
// refused with a reason.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace axg {

/// A block may contain one word of each group. Source: LinuxCNC "G-code overview", modal groups.
enum class ModalGroup : std::uint8_t {
    non_modal,     // G4 G5.3 G10 G28 G52 G53 G92
    motion,        // G0..G3 G5..G5.2 G33 G38 G73 G80..G89
    plane,         // G17..G19
    distance,      // G90 G91
    arc_distance,  // G90.1 G91.1
    feed_mode,     // G93 G94 G95
    units,         // G20 G21
    cutter,        // G40 to G42.1
    tool_length,   // G43 G43.1 G43.4 G49
    offsets,       // G54..G59.3
    path,          // G61 G64
    retract,       // G98 G99
    spindle_mode,  // G96 G97
    stop,          // M0 M1 M2 M30
    tool_change,   // M6
    spindle,       // M3 M4 M5 M19
    coolant,       // M7 M8 M9: M7 and M8 may share a block
    overrides,     // M48 M49 M50 M51 M53
    kinematics,    // M428 M429
    outputs,       // M62 to M68
    saving,        // M70 to M73
    count,
};
inline constexpr std::size_t kModalGroups = static_cast<std::size_t>(ModalGroup::count);

enum class WordSupport : std::uint8_t {
    read,       // changes the motion or the state
    no_motion,  // accepted: moves no axis
    refused,    // an error with `reason`
};

struct GcodeWordRule {
    char letter;        // 'G' or 'M'
    std::int32_t code;  // ten times the number: G91.1 is 911
    ModalGroup group;
    WordSupport support;
    std::string_view reason;  // of a refusal, or the effect of an accepted word
};

[[nodiscard]] std::span<const GcodeWordRule> gcode_word_rules();

/// nullptr: no such word.
[[nodiscard]] const GcodeWordRule* find_gcode_word(char letter, std::int32_t code);

}  // namespace axg
