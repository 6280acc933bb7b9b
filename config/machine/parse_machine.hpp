// SPDX-License-Identifier: Apache-2.0
// load_machine() without the file system: for fuzzing, tests and what writes machine files.
#pragma once

#include <string>
#include <vector>

#include "config/text/config_fault.hpp"
#include "config/text/machine_text.hpp"
#include "config/text/named_file.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// As load_machine(), from text. `file` is the name shown in faults.
/// @param files   how to read a DBC, EDS or DCF file that the text names; without it there is none
/// @param doubts  out, if not null: lines for a person to review
[[nodiscard]] std::vector<ConfigFault> parse_machine(const std::string& text,
                                                     const std::string& file, Machine& out,
                                                     const NamedFiles& files = {},
                                                     std::vector<std::string>* doubts = nullptr);

/// The machine that the text describes, as load_machine() read it; nothing is opened.
[[nodiscard]] std::vector<ConfigFault> parse_machine(const MachineText& source, Machine& out);

/// The same with other values. Each change is YAML of the form of a machine file: each of its keys
/// replaces that of the text, or is added to it; maps are merged.
[[nodiscard]] std::vector<ConfigFault> parse_changed_machine(
    const MachineText& source, const std::vector<std::string>& changes, Machine& out);

}  // namespace axg
