// SPDX-License-Identifier: Apache-2.0
// The form of every message about a wrong input.
#pragma once

#include <string>
#include <string_view>

namespace axg {

/// Begins the `got` of a key that no machine file has.
inline constexpr std::string_view kUnknownKey = "unknown key";

/// `WHAT (found FOUND, expected EXPECTED). ACTION.`
/// @param found     empty: left out
/// @param expected  what would be right; behind the first "; " outside quotes and brackets, the
///                  action: what to do next. Each part may be empty.
[[nodiscard]] std::string fault_text(std::string_view what, std::string_view found,
                                     std::string_view expected);

}  // namespace axg
