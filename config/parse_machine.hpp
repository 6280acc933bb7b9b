// SPDX-License-Identifier: Apache-2.0
// load_machine() without the file system: for fuzzing, tests and what writes machine files.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "config/load_machine.hpp"

namespace axg {

/// A file that a machine file names: its text, or what is wrong and what to do next.
struct NamedFile {
    std::string text, got, wanted;  // got empty: read
};
using NamedFiles = std::function<NamedFile(const std::string& name, std::size_t size_bytes_max)>;

/// As load_machine(), from text. `file` is the name shown in faults.
/// @param files  how to read a DBC, EDS or DCF file that the text names; without it there is none
[[nodiscard]] std::vector<ConfigFault> parse_machine(const std::string& text,
                                                     const std::string& file, Machine& out,
                                                     const NamedFiles& files = {});

}  // namespace axg
