// SPDX-License-Identifier: Apache-2.0
// Captures the stdout of a command for a log.
#pragma once

#include <functional>
#include <string>

namespace axg {

/// Runs `print` and returns what it wrote to stdout. If no temporary file can be created, `print`
/// writes to stdout as usual, and the result is empty. Not for two threads at a time.
[[nodiscard]] std::string captured_stdout(const std::function<void()>& print);

}  // namespace axg
