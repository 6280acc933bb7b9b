// SPDX-License-Identifier: Apache-2.0
// Surfaces of fewer triangles for the engines, if the machine file sets mesh.simplify_mm.
// Meshoptimizer proposes, core/collision/deviation.hpp certifies. The whole surfaces of the bodies
// do not change.
#pragma once

#include <vector>

#include "config/mesh/load_meshes.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

struct SimplifiedMesh {
    Mesh mesh;
    double deviation_mm = 0;  // every point of the whole surface is proven to be that near to it
    double excess_mm = 0;     // and every point of it to the whole surface
};
/// Fewer triangles, deviation and excess at most `most_mm`. Returns `whole`, 0 and 0 if it finds no
/// such surface, or in a build without libmeshoptimizer.
[[nodiscard]] SimplifiedMesh simplify(const Mesh& whole, double most_mm);

/// Simplifies each surface with simplify_mm into `meshes.simple_bodies` and `simple_tools`, and
/// stores the deviation in `machine` (MeshSource::deviation_mm). Faults: not in this build.
[[nodiscard]] std::vector<ConfigFault> simplify_meshes(Machine& machine, MachineMeshes& meshes);

}  // namespace axg
