// SPDX-License-Identifier: Apache-2.0
#include "config/text/number_text.hpp"

#include <charconv>
#include <cmath>

namespace axg {
namespace {

constexpr std::size_t kNumberLengthMax = 64;

bool is_digit(char c) noexcept {
    return c >= '0' && c <= '9';
}

std::size_t digits_from(std::string_view text, std::size_t at) noexcept {
    std::size_t end = at;
    while (end < text.size() && is_digit(text[end])) {
        ++end;
    }
    return end - at;
}

/// Stricter than from_chars(), which accepts "inf", "1." and ".5".
bool follows_grammar(std::string_view text) noexcept {
    std::size_t at = !text.empty() && text[0] == '-' ? 1 : 0;
    const std::size_t whole = digits_from(text, at);
    if (whole == 0 || (whole > 1 && text[at] == '0')) {
        return false;
    }
    at += whole;
    if (at < text.size() && text[at] == '.') {
        const std::size_t fraction = digits_from(text, at + 1);
        if (fraction == 0) {
            return false;
        }
        at += 1 + fraction;
    }
    if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
        ++at;
        if (at < text.size() && (text[at] == '+' || text[at] == '-')) {
            ++at;
        }
        const std::size_t exponent = digits_from(text, at);
        if (exponent == 0) {
            return false;
        }
        at += exponent;
    }
    return at == text.size();
}

}  // namespace

std::optional<double> decimal_number(std::string_view text) noexcept {
    if (text.size() > kNumberLengthMax || !follows_grammar(text)) {
        return std::nullopt;
    }
    double value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool subnormal = value != 0 && !std::isnormal(value);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size() || subnormal) {
        return std::nullopt;  // 1e999, and 1e-999 which would quietly become 0
    }
    return value + 0.0;
}

std::optional<std::uint32_t> whole_number(std::string_view text) noexcept {
    if (text.empty() || digits_from(text, 0) != text.size() ||
        (text.size() > 1 && text[0] == '0')) {
        return std::nullopt;
    }
    std::uint32_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return result.ec == std::errc{} ? std::optional{value} : std::nullopt;
}

std::optional<std::uint32_t> hex_number(std::string_view text) noexcept {
    if (!text.starts_with("0x")) {
        return whole_number(text);
    }
    const std::string_view digits = text.substr(2);
    if (digits.empty() || digits.size() > 8 || digits[0] == '-') {
        return std::nullopt;
    }
    std::uint32_t value = 0;
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    const bool whole = result.ec == std::errc{} && result.ptr == digits.data() + digits.size();
    return whole ? std::optional{value} : std::nullopt;
}

}  // namespace axg
