// SPDX-License-Identifier: Apache-2.0
// The traversal on AVX2 with FMA. Compiled with its flags where the compiler has them
// (core/collision/CMakeLists.txt).
#include "core/collision/lane_kernels.hpp"

#if defined(__AVX2__)
#include "core/collision/lanes_avx2.hpp"
#define AXG_TRAVERSE_LANES ::axg::lanes::Float8
#define AXG_TRAVERSE_NAMESPACE traverse_avx2
#include "core/collision/traverse.inl"

#include "core/collision/tile_test.inl"

namespace axg {
const LaneKernels* avx2_kernels() noexcept {
    static constexpr LaneKernels kKernels{"avx2",
                                          8,
                                          &traverse_avx2::run,
                                          &traverse_avx2::share_tiles,
                                          &traverse_avx2::test_tiles,
                                          &traverse_avx2::measure_tiles,
                                          &traverse_avx2::pair_apart_in_double,
                                          &traverse_avx2::pair_distance_in_double};
    return &kKernels;
}
}  // namespace axg
#else
namespace axg {
const LaneKernels* avx2_kernels() noexcept {
    return nullptr;
}
}  // namespace axg
#endif
