// SPDX-License-Identifier: Apache-2.0
// Commands as text that a person pastes into a shell.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace axg {

/// A word as a shell reads it back: quoted where it holds more than letters, digits and ./:_-
[[nodiscard]] std::string shell_word(const std::string& word);

/// The words as one command; longer than `columns` it goes on in further lines behind a backslash.
/// @param indent  blanks before each line but the first, which begins at this column
[[nodiscard]] std::string shell_command(const std::vector<std::string>& words, std::size_t indent,
                                        std::size_t columns);

/// A path from the working folder or from the root, whichever is shorter.
[[nodiscard]] std::string shorter_path(const std::string& path);

/// How to start this program from here: its name where PATH finds it, else its path.
[[nodiscard]] std::string own_command();

}  // namespace axg
