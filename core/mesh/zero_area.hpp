// SPDX-License-Identifier: Apache-2.0
// Is the area of a facet exactly zero? Decided without rounding, for every float32 input.
#pragma once

#include "core/mesh/mesh.hpp"

namespace axg {

/// Three corners on one line, two or three equal corners included. Exact; finite coordinates
/// without subnormals.
[[nodiscard]] bool has_zero_area(const Triangle& t) noexcept;

}  // namespace axg
