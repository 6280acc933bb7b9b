// SPDX-License-Identifier: Apache-2.0
// Judges surfaces with a method for pairs of triangles: every triangle of one surface against every
// triangle of the other. mm.
#pragma once

#include <span>

#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

/// Verdict: the first of rejected, intersecting, undecided, separated that any pair has. Distance:
/// the least of all pairs (none from an exact method). Cost: triangles of a times triangles of b;
/// skips no pair.
[[nodiscard]] Judged judge_meshes(const Method& method, std::span<const Mesh> meshes,
                                  std::span<const MeshCase> cases);

}  // namespace axg::lab
