// SPDX-License-Identifier: Apache-2.0
// The text a machine was read from: enough to read it again without its files.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace axg {

struct MachineText {
    std::string file;  // its name, without the folder
    std::string text;
    std::map<std::string, std::string> named;  // files that the text names: DBC, EDS, DCF
    std::vector<std::string> doubts{};         // lines for a person to review, found while reading
};

}  // namespace axg
