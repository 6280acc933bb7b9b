// SPDX-License-Identifier: Apache-2.0
// Clearance: computes certified distances in double, one warp per pair, in two steps: first of the
// candidates nearest in float, then of every other candidate whose bound in float is below the
// least distance of the first step. The least value of all pairs is the clearance; no skipped pair
// could be below it.
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"
#include "cuda/engine/warp_double.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 3;
// The clearance of a pair that is proven apart, but by no distance; as in
// core/collision/traverse_clearance.inl.
constexpr double kApart = 0x1p-1000;

__device__ double value_of(const PreparedQuery& q, const TriangleEntry& e, PairVectors& vectors) {
    const WarpPair w = warp_pair(double_pair_of(q, e), vectors);
    const double refined = sat::certified_distance(w.p, warp_closest(w));
    const double value = lanes::max(refined, static_cast<double>(e.low_mm));
    if (!(value > 0) && warp_apart<false>(w, 0.0)) {
        return kApart;  // proven apart along another axis
    }
    return value;
}

__device__ void refine(const DeviceBuffers& b, unsigned step, std::uint32_t query,
                       std::uint32_t index, PairVectors& vectors) {
    Tally& tally = b.tallies[query];
    const std::size_t place = std::size_t{query} * b.limits.candidates + index;
    const TriangleEntry e = b.candidates[place];
    const bool is_first = __float_as_uint(e.low_mm) == tally.least_float;
    const bool is_wanted =
        step == 0 ? is_first
                  : !is_first && e.low_mm < __builtin_bit_cast(double, tally.least_first);
    double value = __longlong_as_double(0x7ff0000000000000LL);
    if (is_wanted) {
        value = value_of(b.prepared[query], e, vectors);
    }
    if (lane_of_thread() == 0) {
        if (is_wanted || step == 0) {
            b.values[place] = value;
        }
        if (is_wanted) {
            lower(step == 0 ? tally.least_first : tally.least_second, value);
        }
        atomicAdd(&tally.candidates_done[step], 1U);
    }
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    refine_distances_kernel(const __grid_constant__ DeviceBuffers b, unsigned step) {
    wait_for_kernel_before();
    __shared__ std::uint32_t counts[kBatchQueriesMax];
    __shared__ PairVectors vectors[kWarps];
    deal(
        b.counters->count, kNoLimit, counts,
        [&b](std::uint32_t query) { return min(b.tallies[query].candidates, b.limits.candidates); },
        [](std::uint32_t, bool) {},
        [&b, step](std::uint32_t query, std::uint32_t index) {
            refine(b, step, query, index, vectors[threadIdx.x / kWarp]);
        });
}

}  // namespace

cudaError_t launch_refine_distances(const DeviceBuffers& buffers, const Launch& launch,
                                    unsigned step) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(refine_distances_kernel, blocks, kThreads, launch, buffers, step);
}

}  // namespace axg::cuda
