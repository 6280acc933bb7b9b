// SPDX-License-Identifier: Apache-2.0
// The shapes of hil_replay/lab/cases/pair_cases.hpp before they are scaled, turned and moved: sizes
// about 1.
#pragma once

#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair.hpp"
#include "hil_replay/lab/cases/pair_categories.hpp"

namespace axg::lab {

/// @param gap  in units of the size; negative: they overlap, or nearly so
[[nodiscard]] Pair<double> make_shape(Draw& draw, const Category& category, double gap);

}  // namespace axg::lab
