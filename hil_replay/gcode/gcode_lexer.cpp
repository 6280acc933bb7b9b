// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode/gcode_lexer.hpp"

#include <optional>

namespace axg {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}
bool is_number_char(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
}

std::string printable(char c) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f) {
        return std::string(1, c);
    }
    constexpr char kHex[] = "0123456789abcdef";
    return std::string("byte 0x") + kHex[byte >> 4U] + kHex[byte & 15U];
}

}  // namespace

bool strip_gcode_line(std::string_view text, std::string& out, GcodeLine& line) {
    bool in_comment = false;
    for (const char c : text) {
        if (in_comment) {
            if (c == '(') {
                line.fault_word.assign(1, '(');
                line.fault = "a comment inside a comment; close the first with ')'";
                return false;
            }
            in_comment = c != ')';
        } else if (c == '(') {
            in_comment = true;
        } else if (c == ';') {
            return true;
        } else if (!is_blank(c)) {
            out.push_back(c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c);
        }
    }
    if (in_comment) {
        line.fault_word.assign(1, '(');
        line.fault = "comment not closed on this line; add ')'";
        return false;
    }
    return true;
}

namespace {

/// Sets the fault for a character that is not a letter where a word has to begin.
void refuse_char(char c, GcodeLine& line) {
    line.fault_word = printable(c);
    switch (c) {
        case '@':
        case '^':
            line.fault = "not supported (polar coordinates; write X and Y)";
            return;
        case '/':
            line.fault = "block delete is only allowed at the start of a line";
            return;
        case '%':
            line.fault = "a percent sign is only allowed alone on its line";
            return;
        default:
            line.fault = "unexpected character (expected a letter and a number)";
    }
}

/// The letter and the following characters that may be its value, for messages.
std::string_view first_word(std::string_view rest) {
    std::size_t end = 1;
    while (end < rest.size() && is_number_char(rest[end])) {
        ++end;
    }
    const bool is_value = end == 1 && rest.size() > 1 && (rest[1] == '#' || rest[1] == '[');
    return rest.substr(0, is_value ? 2 : end);
}

/// Reads one word or assignment from the front. On failure returns false and sets the fault.
bool read_item(std::string_view& rest, bool is_first, const GcodeParameters* parameters,
               GcodeLine& line) {
    const char letter = rest.front();
    if (letter == '#') {
        GcodeValueReader reader(rest, parameters);
        const std::optional<GcodeAssignment> assignment = reader.assignment();
        if (!assignment) {
            line.fault_word.assign(1, '#');
            line.fault = reader.fault();
            return false;
        }
        line.assignments.push_back(*assignment);
        rest = reader.rest();
        return true;
    }
    if (letter < 'A' || letter > 'Z') {
        refuse_char(letter, line);
        return false;
    }
    GcodeValueReader reader(rest.substr(1), letter == 'N' ? nullptr : parameters);
    const std::optional<double> number = reader.value();
    const std::string_view text = rest.substr(0, rest.size() - reader.rest().size());
    if (!number) {
        line.fault_word = std::string(first_word(rest));
        line.fault = reader.fault();
        return false;
    }
    if (letter != 'N') {
        line.words.push_back({letter, *number, std::string(text)});
    } else if (*number < 0) {
        line.fault_word = std::string(text);
        line.fault = "a line number cannot be negative";
        return false;
    } else if (!is_first) {
        line.fault_word = std::string(text);
        line.fault = "a line number is only allowed at the start of a line";
        return false;
    }
    rest = reader.rest();
    return true;
}

void read_words(std::string_view rest, const GcodeParameters* parameters, GcodeLine& line) {
    bool is_first = true;
    while (!rest.empty()) {
        const bool is_fanuc_call = (rest.starts_with("M98") || rest.starts_with("M99")) &&
                                   (rest.size() == 3 || !is_number_char(rest[3]));
        if (is_fanuc_call && parameters != nullptr && line.words.empty() &&
            line.assignments.empty()) {
            line.flow = std::string(rest);
            return;
        }
        if (rest.front() == 'O') {
            const bool is_alone = line.words.empty() && line.assignments.empty();
            if (is_alone && parameters != nullptr) {
                line.flow = std::string(rest);
                return;
            }
            line.fault_word.assign(1, 'O');
            line.fault = is_alone ? "not supported here (subroutines and loops)"
                                  : "an O-word is only allowed at the start of a line";
            return;
        }
        if (!read_item(rest, is_first, parameters, line)) {
            return;
        }
        is_first = false;
    }
}

}  // namespace

GcodeLine lex_gcode_line(std::string_view text, const GcodeParameters* parameters) {
    GcodeLine line;
    if (text.size() > kGcodeLineCharsMax) {
        line.fault_word = "line";
        line.fault = "longer than " + std::to_string(kGcodeLineCharsMax) + " characters";
        return line;
    }
    std::string code;
    code.reserve(text.size());
    if (!strip_gcode_line(text, code, line)) {
        return line;
    }
    std::string_view rest = code;
    if (rest == "%") {
        line.is_percent = true;
        return line;
    }
    if (!rest.empty() && rest.front() == '/') {
        line.block_delete = true;
        rest.remove_prefix(1);
    }
    read_words(rest, parameters, line);
    return line;
}

}  // namespace axg
