// SPDX-License-Identifier: Apache-2.0
// Opens, parses, checks and scales every surface a machine names.
#pragma once

#include <string>
#include <vector>

#include "config/text/config_fault.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

/// Surfaces in mm, float32, each in its own mesh frame.
struct MachineMeshes {
    std::vector<Mesh> bodies;  // [Machine::bodies], without triangles where a body has none (bare
                               // link, tool body)
    std::vector<Mesh> tools;   // [Machine::tools]
    // Replacements for the engines (config/mesh/simplify_meshes.hpp); absent or without triangles:
    // the engines use the surface itself.
    std::vector<Mesh> simple_bodies, simple_tools;
    std::vector<Mesh> of_pairs;      // [PairSurface::surface] surfaces for one pair only
    std::vector<std::string> notes;  // allowed oddities by name: open, dropped facets
};

/// Returns no faults, or all faults at once and leaves `out` untouched.
/// @param mesh_root  folder of the relative file names; no file may leave it, not by links either
[[nodiscard]] std::vector<ConfigFault> load_meshes(const Machine& machine,
                                                   const std::string& mesh_root,
                                                   MachineMeshes& out);

}  // namespace axg
