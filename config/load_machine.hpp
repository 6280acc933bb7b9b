// SPDX-License-Identifier: Apache-2.0
// The only header that leads to YAML. Reads a machine file into plain data, or says everything that
// is wrong with it.
#pragma once

#include <string>
#include <vector>

#include "core/machine.hpp"

namespace axg {

/// One fault of a machine file or of a file it names. Prints as
/// `machine.yaml:14: axes.A.travel_deg: got "2,2", wanted two numbers, low then high`.
struct ConfigFault {
    std::string where;   // FILE:LINE
    std::string key;     // dotted path, list items by name or index
    std::string got;     // as written, control characters escaped
    std::string wanted;  // and what to do next
};
[[nodiscard]] std::string to_string(const ConfigFault& fault);

/// Reads `path`. Either no faults and `out` is complete and consistent, or all faults at once and
/// `out` is untouched. Refuses within a second whatever the file holds. Meshes are not opened here.
[[nodiscard]] std::vector<ConfigFault> load_machine(const std::string& path, Machine& out);

}  // namespace axg
