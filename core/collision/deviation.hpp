// SPDX-License-Identifier: Apache-2.0
// Certified bound of the distance of a surface from another one: the error of a simplified mesh.
// One-sided: a point more than d + deviation from `other` is more than d from `surface`. mm.
// Double, rounded outwards; allocates; init only. Source: docs/theory/simplified.md, "The proof".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace axg {

/// The triangles of `surface` that are not proven to be within `within_mm` of `other`. With them
/// added to `other`, all are. Preconditions as below.
[[nodiscard]] std::vector<std::uint32_t> triangles_beyond(std::span<const Triangle> surface,
                                                          std::span<const Triangle> other,
                                                          double within_mm);

/// The least length found, at most `most_mm`, such that every point of `surface` is proven to be
/// within it of a triangle of `other`. Empty: not even `most_mm` could be proven.
/// Precondition: 1 to kTrianglesMax triangles each, finite, |coordinate| <= kCoordinateMmMax.
[[nodiscard]] std::optional<double> bound_deviation(std::span<const Triangle> surface,
                                                    std::span<const Triangle> other,
                                                    double most_mm);

}  // namespace axg
