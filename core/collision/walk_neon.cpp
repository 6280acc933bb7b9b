// SPDX-License-Identifier: Apache-2.0
// The walk on AArch64 Advanced SIMD. Every AArch64 processor has it.
#include "core/collision/lane_kernels.hpp"

#if defined(__aarch64__)
#include "core/collision/lanes_neon.hpp"
#define AXG_WALK_LANES ::axg::lanes::Float4
#define AXG_WALK_NAMESPACE walk_neon
#include "core/collision/walk.inl"

#include "core/collision/tile_test.inl"

namespace axg {
const LaneKernels* neon_kernels() noexcept {
    static constexpr LaneKernels kKernels{"neon",
                                          4,
                                          &walk_neon::ask,
                                          &walk_neon::share_tiles,
                                          &walk_neon::test_tiles,
                                          &walk_neon::measure_tiles,
                                          &walk_neon::pair_apart_in_double,
                                          &walk_neon::pair_distance_in_double};
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
