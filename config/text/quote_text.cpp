// SPDX-License-Identifier: Apache-2.0
#include "config/text/quote_text.hpp"

#include <array>
#include <cstdio>

namespace axg {
namespace {

bool is_continuation(std::string_view text, std::size_t at) noexcept {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
}

void append_hex(std::string& out, const char* prefix, int digits, std::uint32_t value) {
    std::array<char, 24> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%s%0*x", prefix, digits,
                  static_cast<unsigned>(value));
    out += buffer.data();
}

void append_escape(std::string& out, std::uint32_t value) {
    if (value == '\n') {
        out += "\\n";
    } else if (value == '\r') {
        out += "\\r";
    } else if (value == '\t') {
        out += "\\t";
    } else if (value < 0x80U) {
        append_hex(out, "\\x", 2, value);
    } else {
        append_hex(out, value > 0xFFFFU ? "\\U" : "\\u", value > 0xFFFFU ? 8 : 4, value);
    }
}

std::string escape(std::string_view text, std::size_t length_max, bool with_quotes) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        if (out.size() >= length_max) {
            out += "...";
            break;
        }
        const CodePoint point = code_point_at(text, at);
        if (point.length_bytes == 0) {
            append_hex(out, "\\x", 2, static_cast<unsigned char>(text[at]));
            ++at;
            continue;
        }
        if (is_steering(point.value)) {
            append_escape(out, point.value);
        } else if (with_quotes && (point.value == '"' || point.value == '\\')) {
            out += '\\';
            out += text[at];
        } else {
            out += text.substr(at, point.length_bytes);
        }
        at += point.length_bytes;
    }
    return out;
}

}  // namespace

CodePoint code_point_at(std::string_view text, std::size_t at) noexcept {
    if (at >= text.size()) {
        return {};
    }
    const auto lead = static_cast<unsigned char>(text[at]);
    if (lead < 0x80U) {
        return {.value = lead, .length_bytes = 1};
    }
    const std::uint32_t length = lead >= 0xF0U ? 4U : lead >= 0xE0U ? 3U : 2U;
    if (lead < 0xC2U || lead > 0xF4U) {
        return {};
    }
    std::uint32_t value = lead & (0x7FU >> length);
    for (std::uint32_t i = 1; i < length; ++i) {
        if (!is_continuation(text, at + i)) {
            return {};
        }
        value = value << 6U | (static_cast<unsigned char>(text[at + i]) & 0x3FU);
    }
    const std::uint32_t smallest = length == 4 ? 0x10000U : length == 3 ? 0x800U : 0x80U;
    const bool is_surrogate = value >= 0xD800U && value <= 0xDFFFU;
    if (value < smallest || value > 0x10FFFFU || is_surrogate) {
        return {};
    }
    return {.value = value, .length_bytes = length};
}

bool is_steering(std::uint32_t c) noexcept {
    return c < 0x20U || (c >= 0x7FU && c <= 0x9FU) || c == 0xADU || c == 0x61CU ||
           (c >= 0x200BU && c <= 0x200FU) || (c >= 0x2028U && c <= 0x202EU) ||
           (c >= 0x2060U && c <= 0x206FU) || c == 0xFEFFU || (c >= 0xFFF9U && c <= 0xFFFBU) ||
           (c >= 0xE0000U && c <= 0xE007FU);
}

std::string escaped(std::string_view text, std::size_t length_max) {
    return escape(text, length_max, false);
}

std::string quoted(std::string_view text, std::size_t length_max) {
    return '"' + escape(text, length_max, true) + '"';
}

}  // namespace axg
