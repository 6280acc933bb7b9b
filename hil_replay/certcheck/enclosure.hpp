// SPDX-License-Identifier: Apache-2.0
// Whether a part of one surface is inside the other: crossings of rays, with signs that are sure.
#pragma once

#include <string>
#include <vector>

#include "hil_replay/certcheck/box_tree.hpp"
#include "hil_replay/certcheck/interval.hpp"

namespace axg::certcheck {

/// The connected parts of a surface: a corner of each, and the closed ones' triangles.
struct Parts {
    std::vector<Vector> corners;
    BoxTree closed;
    std::size_t open_count = 0;  // parts that are not closed: nothing can be inside them
};

[[nodiscard]] Parts parts_of(const std::vector<Triangle>& triangles);

/// Whether surely no corner of the parts of one is inside the closed parts of the other. A winding
/// number other than 0 is inside, and so is a point for which none of eight rays is sure.
/// @param one, other to a common frame
[[nodiscard]] bool is_outside(const Parts& one, const Pose& one_pose, const Parts& other,
                              const Pose& other_pose);

}  // namespace axg::certcheck
