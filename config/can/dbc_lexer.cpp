// SPDX-License-Identifier: Apache-2.0
#include "config/can/dbc_lexer.hpp"

#include <algorithm>

namespace axg {
namespace {

using Kind = DbcToken::Kind;

constexpr bool is_digit(char c) noexcept {
    return c >= '0' && c <= '9';
}

constexpr bool is_word(char c) noexcept {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || is_digit(c);
}

/// Length of a number with all letters that follow: 1e-3, 0.5, -12. The parser rejects 0x.
std::size_t number_length(std::string_view text) noexcept {
    std::size_t at = text[0] == '-' || text[0] == '+' ? 1 : 0;
    for (; at < text.size(); ++at) {
        const char c = text[at];
        const bool is_exponent_sign =
            (c == '-' || c == '+') && (text[at - 1] == 'e' || text[at - 1] == 'E');
        if (!is_word(c) && c != '.' && !is_exponent_sign) {
            break;
        }
    }
    return at;
}

/// Both quotation marks included; 0 where the second is missing.
std::size_t text_length(std::string_view text) noexcept {
    for (std::size_t at = 1; at < text.size(); ++at) {
        if (text[at] == '\\') {
            ++at;
        } else if (text[at] == '"') {
            return at + 1;
        }
    }
    return 0;
}

void skip_blanks(std::string_view& rest, int& line) noexcept {
    std::size_t at = 0;
    for (; at < rest.size(); ++at) {
        const char c = rest[at];
        if (c != ' ' && c != '\t' && c != '\r' && c != '\n') {
            break;
        }
        line += c == '\n' ? 1 : 0;
    }
    rest.remove_prefix(at);
}

}  // namespace

DbcToken next_dbc_token(std::string_view& rest, int& line) noexcept {
    skip_blanks(rest, line);
    if (rest.empty()) {
        return {Kind::end, {}, line};
    }
    const char c = rest[0];
    const bool is_number =
        is_digit(c) || ((c == '-' || c == '+') && rest.size() > 1 && is_digit(rest[1]));
    DbcToken token{Kind::broken, rest.substr(0, 1), line};
    std::size_t length = 1;
    if (is_number) {
        length = number_length(rest);
        token = {Kind::number, rest.substr(0, length), line};
    } else if (is_word(c)) {
        const auto* const end = std::find_if_not(rest.begin(), rest.end(), is_word);
        length = static_cast<std::size_t>(end - rest.begin());
        token = {Kind::word, rest.substr(0, length), line};
    } else if (c == '"') {
        length = text_length(rest);
        if (length == 0) {
            rest = {};
            return token;
        }
        token = {Kind::text, rest.substr(1, length - 2), line};
        line += static_cast<int>(std::count(token.text.begin(), token.text.end(), '\n'));
    } else if (std::string_view(":;,|@+-()[]").find(c) != std::string_view::npos) {
        token.kind = Kind::sign;
    }
    rest.remove_prefix(length);
    return token;
}

}  // namespace axg
