// SPDX-License-Identifier: Apache-2.0
// One line of G-code to letters and numbers: blanks, case and comments do not matter, everything
// else does.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hil_replay/gcode/gcode_values.hpp"

namespace axg {

inline constexpr std::size_t kGcodeLineCharsMax = 4096;

struct GcodeWord {
    char letter = 0;  // upper case
    double number = 0;
    std::string text;  // as written, upper case, without blanks: "G91.1"
};

struct GcodeLine {
    bool is_percent = false;       // a line with % alone
    bool block_delete = false;     // began with '/'
    std::vector<GcodeWord> words;  // N words left out
    std::vector<GcodeAssignment> assignments;
    std::string flow;  // an O-word and what follows it, without blanks; there are no words then
    // What stopped the reader; empty when the whole line was read.
    std::string fault_word;
    std::string fault;
};

/// Upper case without blanks and comments; a comment left open is a fault.
[[nodiscard]] bool strip_gcode_line(std::string_view text, std::string& out, GcodeLine& line);

/// Reads one line (without its line end). Never throws on content, whatever the bytes are.
/// @param parameters  null: only plain numbers
/// Source: RS274/NGC section 3.3, LinuxCNC "G-code overview": blanks are removed everywhere outside
/// comments.
[[nodiscard]] GcodeLine lex_gcode_line(std::string_view text,
                                       const GcodeParameters* parameters = nullptr);

}  // namespace axg
