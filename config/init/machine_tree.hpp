// SPDX-License-Identifier: Apache-2.0
// Bodies, parents, directions and pivots from the machine.yml of a QtPyVCP screen, which draws a
// machine in LinuxCNC. It states no tool.
// Source: QtPyVCP ba8f741e (2026-02-23). machine_actor.py, items_recursive: each nested map is a
// part, whatever its key. vtk_backplot.py, move_part: a part turns about its `position`; `origin`
// is stored only; a minus before the axis reverses the motion.
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
