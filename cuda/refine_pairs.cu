// SPDX-License-Identifier: Apache-2.0
// Clearance: certified distances in double, in two steps. First of the candidates that float calls
// nearest; then of every other candidate whose bound in float is below what the first step found.
// The least value of all pairs is the clearance, and no pair that was left out could be below it.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64, kBlocksPerMultiprocessor = 4;
// The clearance of a pair that is proven apart and nothing more, as in core/walk_clearance.inl.
constexpr double kApart = 0x1p-1000;

__device__ double value_of(const Ready& q, const TriangleEntry& e) {
    const sat::TrianglePair<double> p = double_pair_of(q, e);
    const sat::Closest<double> closest = sat::closest_direction(p, sat::axes_of(p));
    const double refined = sat::certified_distance(p, closest.direction);
    const double value = lanes::max(refined, static_cast<double>(e.low_mm));
    if (!(value > 0) && sat::apart_in_double<false>(p, 0.0)) {
        return kApart;  // proven apart along another axis
    }
    return value;
}

__global__ void __launch_bounds__(kThreads)
    refine_pairs_kernel(const __grid_constant__ DeviceBuffers b, unsigned step) {
    for (std::uint32_t question = blockIdx.x; question < b.progress->count; question += gridDim.x) {
        Tally& tally = b.tallies[question];
        const std::uint32_t count = min(tally.candidates, b.limits.candidates);
        const std::size_t row = std::size_t{question} * b.limits.candidates;
        const double first = __builtin_bit_cast(double, tally.least_first);
        for (std::uint32_t i = threadIdx.x; i < count; i += kThreads) {
            const TriangleEntry e = b.candidates[row + i];
            const bool is_first = __float_as_uint(e.low_mm) == tally.least_float;
            if (step == 0) {
                b.values[row + i] = __longlong_as_double(0x7ff0000000000000LL);
            }
            if (step == 0 ? is_first : !is_first && e.low_mm < first) {
                const double value = value_of(b.ready[question], e);
                b.values[row + i] = value;
                lower(step == 0 ? tally.least_first : tally.least_second, value);
            }
            atomicAdd(&tally.candidates_done[step], 1U);
        }
    }
}

}  // namespace

cudaError_t launch_refine_pairs(const DeviceBuffers& buffers, const Launch& launch,
                                unsigned step) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    refine_pairs_kernel<<<blocks, kThreads, 0, launch.stream>>>(buffers, step);
    return cudaGetLastError();
}

}  // namespace axg::cuda
