// SPDX-License-Identifier: Apache-2.0
// Splits one line of G-code into letters and numbers. Ignores blanks, case and comments, and
// nothing else.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hil_replay/gcode/gcode_values.hpp"

namespace axg {

inline constexpr std::size_t kGcodeLineCharsMax = 253;  // LinuxCNC 2.9, LINELEN

struct GcodeWord {
    char letter = 0;  // upper case
    double number = 0;
    std::string text;  // as written, upper case, without blanks: "G91.1"
};

struct GcodeLine {
    bool is_percent = false;       // a line with only %
    bool block_delete = false;     // began with '/'
    std::vector<GcodeWord> words;  // without N words
    std::vector<GcodeAssignment> assignments;
    std::string flow;  // an O-word, M98 or M99, and the text after it, without blanks; `words` is
                       // then empty
    // The first fault; empty if the whole line was read.
    std::string fault_word;
    std::string fault;
};

/// Converts to upper case without blanks and comments; an open or nested comment is a fault.
[[nodiscard]] bool strip_gcode_line(std::string_view text, std::string& out, GcodeLine& line);

/// Reads one line (without its line end). Never throws on content, whatever the bytes are.
/// @param parameters  null: only plain numbers
/// Source: RS274/NGC section 3.3, LinuxCNC "G-code overview": blanks are removed everywhere outside
/// comments.
[[nodiscard]] GcodeLine lex_gcode_line(std::string_view text,
                                       const GcodeParameters* parameters = nullptr);

}  // namespace axg
