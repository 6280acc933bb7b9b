// SPDX-License-Identifier: Apache-2.0
// What a command prints on stdout, taken for a log in place of the terminal.
#pragma once

#include <functional>
#include <string>

namespace axg {

/// Runs `print` and returns what it wrote to stdout. Where no temporary file can be made it prints
/// as ever, and the result is empty. Not for two threads at a time.
[[nodiscard]] std::string captured_stdout(const std::function<void()>& print);

}  // namespace axg
