// SPDX-License-Identifier: Apache-2.0
// Foreign text made safe to print: a machine file must not be able to steer the terminal that shows
// its faults.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace axg {

/// One character of UTF-8 at `text[at]`. length_bytes is 0 where the bytes are not UTF-8
/// (overlong forms, surrogates and values above U+10FFFF included).
struct CodePoint {
    std::uint32_t value = 0;
    std::uint32_t length_bytes = 0;
};
[[nodiscard]] CodePoint code_point_at(std::string_view text, std::size_t at) noexcept;

/// True for what a terminal or an editor may act upon instead of showing: C0 and C1 controls, DEL,
/// and the characters that turn the direction of writing or have no width.
[[nodiscard]] bool is_steering(std::uint32_t code_point) noexcept;

/// The text without quotation marks, every steering character and broken byte as an escape: \n,
/// \x1b, \u202e. Longer texts are cut at about `length_max` bytes and end in "...".
[[nodiscard]] std::string escaped(std::string_view text, std::size_t length_max = 120);

/// escaped(), in double quotation marks; quotation marks and backslashes inside are escaped as
/// well.
[[nodiscard]] std::string quoted(std::string_view text, std::size_t length_max = 120);

}  // namespace axg
