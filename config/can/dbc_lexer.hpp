// SPDX-License-Identifier: Apache-2.0
// Cuts the text of a DBC file into words, numbers, texts and signs.
#pragma once

#include <string_view>

namespace axg {

struct DbcToken {
    enum class Kind { end, word, number, text, sign, broken };
    Kind kind = Kind::end;
    std::string_view text;  // of a text: without its quotation marks, escapes as written
    int line = 1;

    [[nodiscard]] bool is(std::string_view wanted) const noexcept {
        return (kind == Kind::word || kind == Kind::sign) && text == wanted;
    }
};

/// Returns the token at the start of `rest` and removes it from there; `line` counts line ends. A
/// sign before a digit is part of the number. broken: a text without its closing quotation mark, or
/// a byte of no token.
[[nodiscard]] DbcToken next_dbc_token(std::string_view& rest, int& line) noexcept;

}  // namespace axg
