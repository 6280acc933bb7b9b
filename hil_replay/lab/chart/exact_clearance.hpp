// SPDX-License-Identifier: Apache-2.0
// The true distance of two surfaces, from exact arithmetic on the few pairs of triangles that can
// hold it.
#pragma once

#include <vector>

#include "core/base/pose.hpp"
#include "core/mesh/mesh.hpp"

namespace axg::chart {

/// Distance of a placed at `pose` in b's frame, mm, rounded down; 0 where they touch. `within_mm`
/// must be at least that distance: pairs whose boxes are farther apart are skipped.
/// Cost: all pairs of boxes, then some 30 us for each pair of triangles within 1 um of the nearest.
[[nodiscard]] double exact_clearance_mm(const std::vector<Triangle>& a, const Pose& pose,
                                        const std::vector<Triangle>& b, double within_mm);

}  // namespace axg::chart
