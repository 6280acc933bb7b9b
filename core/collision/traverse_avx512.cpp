// SPDX-License-Identifier: Apache-2.0
// The traversal on AVX-512. Compiled with its flags where the compiler has them
// (core/collision/CMakeLists.txt).
#include "core/collision/lane_kernels.hpp"

#if defined(__AVX512F__)
#include "core/collision/lanes_avx512.hpp"
#define AXG_TRAVERSE_LANES ::axg::lanes::Float16
#define AXG_TRAVERSE_NAMESPACE traverse_avx512
#include "core/collision/traverse.inl"

#include "core/collision/tile_test.inl"

namespace axg {
const LaneKernels* avx512_kernels() noexcept {
    static constexpr LaneKernels kKernels{"avx512",
                                          16,
                                          &traverse_avx512::run,
                                          &traverse_avx512::share_tiles,
                                          &traverse_avx512::test_tiles,
                                          &traverse_avx512::measure_tiles,
                                          &traverse_avx512::pair_apart_in_double,
                                          &traverse_avx512::pair_distance_in_double};
    return &kKernels;
}
}  // namespace axg
#else
namespace axg {
const LaneKernels* avx512_kernels() noexcept {
    return nullptr;
}
}  // namespace axg
#endif
