// SPDX-License-Identifier: Apache-2.0
// "Did you mean": the allowed word that a person most likely meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace axg {

/// The nearest of the allowed words, at most about a third of its letters from `word` (at least one
/// slip: a letter missing, added, wrong, in the wrong case, or two swapped; a character that is not
/// ASCII counts as one wrong letter). Empty when none is near. First of equals. Words over 64 bytes
/// are not compared.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            std::span<const std::string_view> known);

/// "a, b, c"
[[nodiscard]] std::string listed(std::span<const std::string_view> words);

/// For "expected": all names, then the nearest one as a suggestion.
[[nodiscard]] std::string wanted_name(std::string_view what, std::string_view got,
                                      std::span<const std::string_view> names);

}  // namespace axg
