// SPDX-License-Identifier: Apache-2.0
#include "config/text/fault_text.hpp"

#include <cstddef>

namespace axg {
namespace {

/// Position of the first "; " outside quotes and brackets; the action follows it. npos: none.
std::size_t semicolon_in(std::string_view text) {
    int depth = 0;
    bool is_quoted = false;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (is_quoted && c == '\\') {
            ++at;
        } else if (c == '"') {
            is_quoted = !is_quoted;
        } else if (!is_quoted && (c == '(' || c == '[' || c == '{')) {
            ++depth;
        } else if (!is_quoted && (c == ')' || c == ']' || c == '}')) {
            --depth;
        } else if (!is_quoted && depth <= 0 && text.substr(at, 2) == "; ") {
            return at;
        }
    }
    return std::string_view::npos;
}

std::string sentence(std::string_view text) {
    std::string out(text);
    if (out[0] >= 'a' && out[0] <= 'z') {
        out[0] = static_cast<char>(out[0] - 'a' + 'A');
    }
    return out.back() == '?' || out.back() == '.' ? out : out + '.';
}

}  // namespace

std::string fault_text(std::string_view what, std::string_view found, std::string_view expected) {
    const std::size_t end = semicolon_in(expected);
    const std::string_view action =
        end == std::string_view::npos ? std::string_view() : expected.substr(end + 2);
    expected = expected.substr(0, end);
    std::string facts;
    if (!found.empty()) {
        facts.append("found ").append(found);
    }
    if (!expected.empty()) {
        facts.append(facts.empty() ? "" : ", ").append("expected ").append(expected);
    }
    std::string out(what);
    if (!facts.empty()) {
        out.append(" (").append(facts).append(")");
    }
    out += '.';
    if (!action.empty()) {
        out.append(" ").append(sentence(action));
    }
    return out;
}

}  // namespace axg
