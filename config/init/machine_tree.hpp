// SPDX-License-Identifier: Apache-2.0
// Bodies, parents and pivots from the machine.yml of a QtPyVCP screen, which draws a machine in
// LinuxCNC. It states neither which way a body moves nor a tool.
// Source: the machine.yml of Probe Basic's simulator and how its program draws it.
#pragma once

#include <string>
#include <vector>

#include "config/init/guess_roles.hpp"
#include "config/text/config_fault.hpp"
#include "core/base/vec3.hpp"

namespace axg {

struct MachineTree {
    std::vector<RoleGuess> roles;     // parents first
    std::vector<ConfigFault> faults;  // not empty: `roles` are of no use
};

/// @param name       of the file, for messages
/// @param files      the meshes; a body has the one whose name its model ends with
/// @param length_mm  of the unit of the file's positions
[[nodiscard]] MachineTree read_machine_tree(const std::string& text, const std::string& name,
                                            const std::vector<std::string>& files,
                                            double length_mm);

}  // namespace axg
