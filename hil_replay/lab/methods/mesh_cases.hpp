// SPDX-License-Identifier: Apache-2.0
// Surfaces against surfaces by a method that knows pairs of triangles alone: every triangle of one
// against every triangle of the other. mm.
#pragma once

#include <span>

#include "hil_replay/lab/cases/tritri_file.hpp"
#include "hil_replay/lab/methods/method.hpp"

namespace axg::lab {

/// Intersecting where one pair is, else undecided where one pair is, else separated; the distance
/// is the least of all pairs (not told by an exact method). Cost: triangles of a times triangles of
/// b, no pair left out.
[[nodiscard]] Judged judge_meshes(const Method& method, std::span<const Mesh> meshes,
                                  std::span<const MeshCase> cases);

}  // namespace axg::lab
