// SPDX-License-Identifier: Apache-2.0
// Writes a file whole or not at all: nobody ever reads half of it.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace axg {

/// Writes to a temporary name beside `path`, then renames. What is no regular file (a pipe,
/// /dev/stdout) is written to directly. On failure false, and the reason on `messages`.
[[nodiscard]] bool write_whole_file(const std::string& path, std::string_view text,
                                    std::FILE* messages);

}  // namespace axg
