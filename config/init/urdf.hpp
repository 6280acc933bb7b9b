// SPDX-License-Identifier: Apache-2.0
// A machine from a URDF file: bodies from its links, axes from its joints. URDF states no stop,
// acceleration, jerk, tool or frame of a bus.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "config/init/guess_roles.hpp"
#include "config/init/linuxcnc_ini.hpp"
#include "config/text/config_fault.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct UrdfMesh {
    std::string file;  // below the folder of the meshes
    LengthUnit unit = LengthUnit::m;
};

struct UrdfMachine {
    std::vector<RoleGuess> roles;  // parents first; `file` is an index of `meshes`
    std::vector<UrdfMesh> meshes;
    IniAxes axes;                     // travel and speeds of the joints
    std::vector<ConfigFault> faults;  // not empty: the rest is of no use
};

/// @param name      of the file, for messages
/// @param has_file  whether the folder of the meshes contains this path. A mesh is the longest end
///                  of its file name that it contains: packages and folders in front are dropped
[[nodiscard]] UrdfMachine read_urdf(const std::string& text, const std::string& name,
                                    const std::function<bool(const std::string&)>& has_file);

}  // namespace axg
