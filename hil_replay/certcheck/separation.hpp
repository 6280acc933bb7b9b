// SPDX-License-Identifier: Apache-2.0
// A descent through the boxes of two surfaces with given directions: no search. A direction that
// separates two hulls by g bounds their distance by g, and opening a node keeps all its children.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "hil_replay/certcheck/box_tree.hpp"
#include "hil_replay/certcheck/interval.hpp"

namespace axg::certcheck {

using Direction = std::array<float, 3>;  // of the frame of surface b

struct PlacedSurface {
    const BoxTree& tree;
    const Pose& pose;
};

/// Why the two surfaces are not proven farther apart than r mm, or nothing: they are.
[[nodiscard]] std::string not_separated(const PlacedSurface& a, const PlacedSurface& b,
                                        const std::vector<Direction>& directions, double r);

}  // namespace axg::certcheck
