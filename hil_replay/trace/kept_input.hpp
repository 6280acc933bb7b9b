// SPDX-License-Identifier: Apache-2.0
// Inputs that can be read once only, such as pipes: their bytes are kept, for a trace is opened
// several times, and looked into before it is read.
#pragma once

#include <cstdio>
#include <string>

namespace axg {

/// As std::fopen(path, "rb"); "-" is standard input. What is no file or folder is read to its end
/// at the first call, into a temporary file without a name; this and every later call open that
/// one. Null with errno.
[[nodiscard]] std::FILE* open_input(const std::string& path);

/// Whether there is something to read; false: probably a wrong name.
[[nodiscard]] bool is_readable_input(const std::string& path);

}  // namespace axg
