// SPDX-License-Identifier: Apache-2.0
// What the stated errors of joints and places take from the distance of two bodies: pivots,
// directions of axes, places of bodies and tools that a shop does not know exactly, and the skew of
// gantries.
// Claim: the true distance is at most this much below that of the machine file, at all positions
// within `within`. Proof: docs/theory/certificate.md, "Stated errors". Test:
// tests/property/core/certificate/pose_error_test.cpp.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/limits.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// The largest |position| of each linear axis that a box of the guard may contain, mm: beyond the
/// travel by two of its longest stops. A box beyond it is refused. Rotary: 0.
[[nodiscard]] std::array<double, kAxesMax> error_range(const Machine& machine) noexcept;

/// mm, rounded up.
/// @param tool      of the pair; kNoIndex: none
/// @param a, b      extents of the whole surfaces
/// @param within    error_range
[[nodiscard]] double pose_error_mm(const Machine& machine, const Pair& pair, std::uint32_t tool,
                                   const BodyExtent& a, const BodyExtent& b,
                                   const std::array<double, kAxesMax>& within) noexcept;

}  // namespace axg
