// SPDX-License-Identifier: Apache-2.0
// The only grammar in which a machine file may write a number: that of JSON, and 0x... for CAN
// identifiers. No locale, no octal, no leading plus, no NaN, no infinity, no underscore, no unit
// behind the digits.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace axg {

/// -?(0|[1-9][0-9]*)(.[0-9]+)?([eE][+-]?[0-9]+)?, at most 64 characters, within double's normal
/// range. Negative zero becomes zero. Any other text returns nullopt.
[[nodiscard]] std::optional<double> decimal_number(std::string_view text) noexcept;

/// 0|[1-9][0-9]*, at most 2^32 - 1.
[[nodiscard]] std::optional<std::uint32_t> whole_number(std::string_view text) noexcept;

/// A whole number, or 0x and one to eight hexadecimal digits.
[[nodiscard]] std::optional<std::uint32_t> hex_number(std::string_view text) noexcept;

}  // namespace axg
