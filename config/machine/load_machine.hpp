// SPDX-License-Identifier: Apache-2.0
// The only header that leads to YAML. Reads a machine file into plain data, or returns all of its
// faults.
#pragma once

#include <string>
#include <vector>

#include "config/text/config_fault.hpp"
#include "config/text/machine_text.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Reads a machine file. Either no faults and `out` is complete and consistent, or all faults at
/// once and `out` is untouched. Refuses within a second whatever the file holds. Meshes are not
/// opened here.
/// @param source  out: what was read, to be read again without the files
[[nodiscard]] std::vector<ConfigFault> load_machine(const std::string& path, Machine& out,
                                                    MachineText& source);

}  // namespace axg
