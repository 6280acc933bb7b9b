// SPDX-License-Identifier: Apache-2.0
// Every bound of the cycle in one place, related at compile time. Data larger than these is refused
// at init.
#pragma once

#include <cstdint>

namespace axg {

inline constexpr std::uint32_t kAxesMax = 16;    // axes of one machine
inline constexpr std::uint32_t kBodiesMax = 32;  // rigid bodies, the tool body included
inline constexpr std::uint32_t kPairsMax = 256;  // checked pairs
inline constexpr std::uint32_t kToolsMax = 64;   // preloaded tool slots
inline constexpr std::uint32_t kMeshesMax = kBodiesMax + kToolsMax;
// Triangles of one mesh; also bounds an STL before allocation.
inline constexpr std::uint32_t kTrianglesMax = 1U << 22;
// |vertex| and |translation|; far inside the 2^30 of the proof.
inline constexpr double kCoordinateMmMax = 1.0e5;

// Largest deviation of a simplified surface: both of a pair count as an error of the pose, of which
// engines accept 1 mm.
inline constexpr double kSimplifyMmMax = 0.4;
// Of all errors of a query's pose: simplified surfaces, stated errors, skew. Engines refuse more.
inline constexpr double kPoseErrorMmMax = 1.0;
inline constexpr double kSkewMmMax = 0.15;  // of all axes together

// Children a node, triangles a leaf: one warp, two AVX-512 lanes.
inline constexpr std::uint32_t kNodeWidth = 32;
inline constexpr std::uint32_t kTreeDepthMax = 8;  // levels of boxes over the triangles

static_assert(kPairsMax <= 0xffffU, "a pair index travels in 16 bits");

}  // namespace axg
