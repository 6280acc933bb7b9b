// SPDX-License-Identifier: Apache-2.0
// Tests every pair of triangles of two bodies on one core of the processor: like the seed paper's
// CPU program, and certified with the widest lanes. For comparison only.
#pragma once

#include "core/collision/lane_kernels.hpp"
#include "cuda/paper/paper_scene.hpp"

namespace axg::paper {

/// The 6-or-11 test of every pair, one after the other, scalar.
/// @param pose  a's frame to b's
[[nodiscard]] Found test_naively(const Body& a, const Body& b, const Pose& pose) noexcept;

/// The certified test of every pair, 32 at a time; tests pairs that float cannot decide in double.
[[nodiscard]] Found test_certified(const LaneKernels& lanes, const Body& a, const Body& b,
                                   const Pose& pose) noexcept;

}  // namespace axg::paper
