// SPDX-License-Identifier: Apache-2.0
// Clearance: finds the pair of triangles that set it. Of equal pairs it is the one with the lowest
// ids, so that the result does not depend on the order of work.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64, kBlocksPerMultiprocessor = 4;

__global__ void __launch_bounds__(kThreads)
    pick_nearest_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    for (std::uint32_t query = blockIdx.x; query < b.counters->count; query += gridDim.x) {
        Tally& tally = b.tallies[query];
        const std::uint32_t count = min(tally.candidates, b.limits.candidates);
        const std::size_t row = std::size_t{query} * b.limits.candidates;
        const double best = __builtin_bit_cast(double, min(tally.least_first, tally.least_second));
        for (std::uint32_t i = threadIdx.x; i < count; i += kThreads) {
            if (b.values[row + i] == best) {
                const TriangleIds ids = ids_of(b.prepared[query], b.candidates[row + i]);
                atomicMin(&tally.nearest, static_cast<unsigned long long>(ids.a) << 32U | ids.b);
            }
            atomicAdd(&tally.candidates_done[2], 1U);
        }
    }
}

}  // namespace

cudaError_t launch_pick_nearest(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(pick_nearest_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
