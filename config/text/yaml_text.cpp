// SPDX-License-Identifier: Apache-2.0
#include "config/text/yaml_text.hpp"

#include "config/text/fault_list.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/yaml_tree.hpp"

namespace axg {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace

YamlText::YamlText(std::string_view text) : text_(text) {
    // Editors on some systems write the mark; the parser skips it, and so do its columns.
    line_starts_.push_back(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n') {
            line_starts_.push_back(i + 1);
        }
    }
}

char YamlText::at(int line, int column) const noexcept {
    if (line < 0 || column < 0 || static_cast<std::size_t>(line) >= line_starts_.size()) {
        return '\0';
    }
    const std::size_t i =
        line_starts_[static_cast<std::size_t>(line)] + static_cast<std::size_t>(column);
    return i < text_.size() ? text_[i] : '\0';
}

bool YamlText::check(FaultList& faults) const {
    if (text_.size() > kYamlSizeBytesMax) {
        faults.add(1, "", std::to_string(text_.size()) + " bytes",
                   "at most " + std::to_string(kYamlSizeBytesMax) + " bytes");
        return false;
    }
    for (std::size_t line = 0; line < line_starts_.size(); ++line) {
        if (at(static_cast<int>(line), 0) == '%') {
            faults.add(static_cast<int>(line) + 1, "", "a directive (%)",
                       "no line that starts with %; directives are not supported");
            return false;
        }
    }
    return check_signs(faults) && check_characters(faults);
}

/// The parser stores every sign of an open list before it passes the first one on. A file with more
/// signs than this limit has too many values anyway; this check only finds it sooner.
bool YamlText::check_signs(FaultList& faults) const {
    constexpr std::string_view kSigns = "[]{},&*!?";
    std::uint32_t count = 0;
    int line = 1;
    for (const char c : text_) {
        line += c == '\n' ? 1 : 0;
        count += kSigns.find(c) != std::string_view::npos ? 1U : 0U;
        if (count > 3 * kYamlNodesMax) {
            faults.add(line, "",
                       "more than " + std::to_string(3 * kYamlNodesMax) +
                           " brackets, commas and other signs",
                       "a machine file with at most " + std::to_string(kYamlNodesMax) + " values");
            return false;
        }
    }
    return true;
}

bool YamlText::check_characters(FaultList& faults) const {
    int line = 1;
    for (std::size_t i = line_starts_[0]; i < text_.size();) {
        const CodePoint point = code_point_at(text_, i);
        if (point.length_bytes == 0) {
            faults.add(line, "", "the byte " + escaped(text_.substr(i, 1)) + " which is not UTF-8",
                       "UTF-8 text; save the file in that encoding");
            return false;
        }
        const bool is_line_end =
            point.value == '\n' || (point.value == '\r' && text_.substr(i + 1, 1) == "\n");
        if (is_steering(point.value) && !is_line_end && point.value != '\t') {
            faults.add(line, "",
                       "the control character " + escaped(text_.substr(i, point.length_bytes)),
                       "visible text; remove it");
            return false;
        }
        line += point.value == '\n' ? 1 : 0;
        i += point.length_bytes;
    }
    return true;
}

}  // namespace axg
