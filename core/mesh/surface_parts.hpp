// SPDX-License-Identifier: Apache-2.0
// A surface taken apart for containment: which facets belong to a closed shell, and a few corners
// of each connected part. Init only.
#pragma once

#include <span>

#include "core/mesh/mesh.hpp"

namespace axg {

/// Corners are shared when their coordinates are equal, as in check_mesh. Allocates.
[[nodiscard]] SurfaceParts take_apart(std::span<const Triangle> facets);

/// The parts stored in the mesh, or else the result of take_apart().
[[nodiscard]] SurfaceParts parts_of(const Mesh& mesh);

}  // namespace axg
