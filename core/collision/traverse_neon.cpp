// SPDX-License-Identifier: Apache-2.0
// The traversal on AArch64 Advanced SIMD. Every AArch64 processor has it.
#include "core/collision/lane_kernels.hpp"

#if defined(__aarch64__)
#include "core/collision/lanes_neon.hpp"
#define AXG_TRAVERSE_LANES ::axg::lanes::Float4
#define AXG_TRAVERSE_NAMESPACE traverse_neon
#include "core/collision/traverse.inl"

#include "core/collision/tile_test.inl"

namespace axg {
const LaneKernels* neon_kernels() noexcept {
    static constexpr LaneKernels kKernels{"neon",
                                          4,
                                          &traverse_neon::run,
                                          &traverse_neon::share_tiles,
                                          &traverse_neon::test_tiles,
                                          &traverse_neon::measure_tiles,
                                          &traverse_neon::pair_apart_in_double,
                                          &traverse_neon::pair_distance_in_double};
    return &kKernels;
}
}  // namespace axg
#else
namespace axg {
const LaneKernels* neon_kernels() noexcept {
    return nullptr;
}
}  // namespace axg
#endif
