// SPDX-License-Identifier: Apache-2.0
// Lines of a text that another computer wrote: LF, CR LF or CR alone ends one.
#pragma once

#include <string_view>

namespace axg {

/// Takes one line from the front of `text` and returns it without its end.
/// @param is_lone_return  set to true if a CR alone ended the line; else unchanged
inline std::string_view take_text_line(std::string_view& text, bool* is_lone_return = nullptr) {
    const std::size_t end = text.find_first_of("\r\n");
    const std::string_view line = text.substr(0, end);
    if (end == std::string_view::npos) {
        text = {};
        return line;
    }
    const bool is_return = text[end] == '\r';
    text.remove_prefix(end + 1);
    if (is_return && text.starts_with('\n')) {
        text.remove_prefix(1);
    } else if (is_return && is_lone_return != nullptr) {
        *is_lone_return = true;
    }
    return line;
}

}  // namespace axg
