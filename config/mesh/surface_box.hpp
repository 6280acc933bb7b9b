// SPDX-License-Identifier: Apache-2.0
// The box of a surface, and lengths to compare it by.
#pragma once

#include <span>

#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

struct SurfaceBox {
    Vec3d low_mm{}, high_mm{};
};

/// @param at  maps the triangles to the frame of the box
[[nodiscard]] SurfaceBox box_of(std::span<const Triangle> triangles, const Pose& at = {});
[[nodiscard]] double longest_side(Vec3d size_mm) noexcept;

/// Factor of a size if a file that was read in `from` were read in `to`.
[[nodiscard]] double scale_between(LengthUnit from, LengthUnit to) noexcept;

/// The upper one of an even count: of two bodies the larger one is believed. 0: of none.
[[nodiscard]] double median_side(std::span<const double> sides_mm);

}  // namespace axg
