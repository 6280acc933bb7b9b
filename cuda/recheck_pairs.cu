// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles that float could not tell apart, asked again in double of the un-rounded
// vertices; what stays undecided counts as touching.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64, kBlocksPerMultiprocessor = 4;

__device__ void note_touching(const DeviceBuffers& b, std::uint32_t question, const Ready& q,
                              const TriangleEntry& e) {
    atomicAdd(&b.tallies[question].touching, 1U);
    if (!q.wants_list) {
        return;
    }
    const std::uint32_t slot = atomicAdd(&b.tallies[question].listed, 1U);
    if (slot < b.limits.listed) {
        b.listed[std::size_t{question} * b.limits.listed + slot] = ids_of(q, e);
    }
}

__global__ void __launch_bounds__(kThreads)
    recheck_pairs_kernel(const __grid_constant__ DeviceBuffers b) {
    for (std::uint32_t question = blockIdx.x; question < b.progress->count; question += gridDim.x) {
        Tally& tally = b.tallies[question];
        const std::uint32_t count = min(tally.rechecks, b.limits.rechecks);
        const std::size_t row = std::size_t{question} * b.limits.rechecks;
        for (std::uint32_t i = threadIdx.x; i < count; i += kThreads) {
            const Ready& q = b.ready[question];
            const TriangleEntry e = b.rechecks[row + i];
            const sat::TrianglePair<double> p = double_pair_of(q, e);
            const bool apart = q.c.has_margin ? sat::apart_in_double<true>(p, q.c.margin64)
                                              : sat::apart_in_double<false>(p, 0.0);
            if (!apart) {
                note_touching(b, question, q, e);
            }
            atomicAdd(&tally.recheck_done, 1U);
        }
    }
}

}  // namespace

cudaError_t launch_recheck_pairs(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    recheck_pairs_kernel<<<blocks, kThreads, 0, launch.stream>>>(buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
