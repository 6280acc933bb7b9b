// SPDX-License-Identifier: Apache-2.0
// The words a machine was read from: all that has to be kept to read it again without its files.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "config/load_machine.hpp"

namespace axg {

struct MachineText {
    std::string file;  // its name, without the folder
    std::string text;
    std::map<std::string, std::string> named;  // files that the text names: DBC, EDS, DCF
};

/// load_machine(), and what it read.
[[nodiscard]] std::vector<ConfigFault> load_machine(const std::string& path, Machine& out,
                                                    MachineText& source);

/// The machine that the words say, as load_machine() read it; nothing is opened.
[[nodiscard]] std::vector<ConfigFault> parse_machine(const MachineText& source, Machine& out);

}  // namespace axg
