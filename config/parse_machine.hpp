// SPDX-License-Identifier: Apache-2.0
// load_machine() without the file system: for fuzzing, tests and what writes machine files.
#pragma once

#include <string>
#include <vector>

#include "config/load_machine.hpp"

namespace axg {

/// As load_machine(), from text. `file` is the name shown in faults.
[[nodiscard]] std::vector<ConfigFault> parse_machine(const std::string& text,
                                                     const std::string& file, Machine& out);

}  // namespace axg
