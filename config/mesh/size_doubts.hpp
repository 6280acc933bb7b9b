// SPDX-License-Identifier: Apache-2.0
// Surfaces whose size contradicts the rest of the machine file: a wrong unit reads without a fault,
// and a body that shrinks to a speck never collides.
#pragma once

#include <vector>

#include "config/text/config_fault.hpp"
#include "core/machine/machine.hpp"

namespace axg {

struct MachineMeshes;

/// A body from a file is doubted where its longest side is less than this share of the median body.
inline constexpr double kLeastShareOfMedian = 1.0 / 50;
/// A surface from a file is doubted where its longest side is shorter, mm.
inline constexpr double kLeastSideMm = 1;
/// The tip of a tool may be off `length_mm` by the larger one: `simulate` places the tip by the
/// length, the proof uses the surface, and regrinding and rounded corners change up to 1 mm.
inline constexpr double kTipToleranceMm = 1, kTipToleranceRelative = 0.01;

/// One fault for each doubted surface, with its extents and the unit that fits; none where the
/// machine file sets size_is_right. Shapes of bodies state mm in each key and are not doubted.
/// @param meshes  as load_meshes() returned them
[[nodiscard]] std::vector<ConfigFault> doubt_sizes(const Machine& machine,
                                                   const MachineMeshes& meshes);

}  // namespace axg
