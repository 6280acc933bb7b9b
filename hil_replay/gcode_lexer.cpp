// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/gcode_lexer.hpp"

#include <charconv>
#include <cmath>
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

/// Removes comments and blanks and raises letters to upper case; a comment left open is a fault.
bool strip(std::string_view text, std::string& out, GcodeLine& line) {
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

/// Why a character that is neither letter nor number stops the reader.
void refuse_char(char c, GcodeLine& line) {
    line.fault_word = printable(c);
    switch (c) {
        case '#':
            line.fault = "not supported (parameters; write the numbers themselves)";
            return;
        case '[':
            line.fault = "not supported (expressions; write the numbers themselves)";
            return;
        case '@':
        case '^':
            line.fault = "not supported (polar coordinates; write X and Y)";
            return;
        case '/':
            line.fault = "block delete stands at the start of a line only";
            return;
        case '%':
            line.fault = "a percent sign stands alone on its line";
            return;
        default:
            line.fault = "got this character, wanted a letter and a number";
    }
}

/// RS274 number: sign, digits, one point; no exponent.
std::optional<double> read_number(std::string_view text) {
    if (!text.empty() && text.front() == '+') {
        text.remove_prefix(1);
        if (!text.empty() && text.front() == '-') {
            return std::nullopt;
        }
    }
    double value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

void read_words(std::string_view rest, GcodeLine& line) {
    bool first = true;
    while (!rest.empty()) {
        const char letter = rest.front();
        if (letter < 'A' || letter > 'Z') {
            refuse_char(letter, line);
            return;
        }
        if (letter == 'O') {
            line.fault_word.assign(1, 'O');
            line.fault = "not supported (O-words: subroutines and loops; expand the program first)";
            return;
        }
        std::size_t end = 1;
        while (end < rest.size() && is_number_char(rest[end])) {
            ++end;
        }
        if (end == 1 && rest.size() > 1 && (rest[1] == '#' || rest[1] == '[')) {
            refuse_char(rest[1], line);
            line.fault_word = std::string(rest.substr(0, 2));
            return;
        }
        const auto number = read_number(rest.substr(1, end - 1));
        if (!number) {
            line.fault_word = std::string(rest.substr(0, end));
            line.fault = "wanted a number after the letter, such as 12, -0.5 or .25";
            return;
        }
        if (letter != 'N') {
            line.words.push_back({letter, *number, std::string(rest.substr(0, end))});
        } else if (!first) {
            line.fault_word = std::string(rest.substr(0, end));
            line.fault = "a line number stands at the start of a line only";
            return;
        }
        first = false;
        rest.remove_prefix(end);
    }
}

}  // namespace

GcodeLine lex_gcode_line(std::string_view text) {
    GcodeLine line;
    if (text.size() > kGcodeLineCharsMax) {
        line.fault_word = "line";
        line.fault = "longer than " + std::to_string(kGcodeLineCharsMax) + " characters";
        return line;
    }
    std::string code;
    code.reserve(text.size());
    if (!strip(text, code, line)) {
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
    read_words(rest, line);
    return line;
}

}  // namespace axg
