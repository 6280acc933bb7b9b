// SPDX-License-Identifier: Apache-2.0
// Tests the pairs that the first certified stage left undecided, one warp per pair: each axis by
// itself in float, then in double with one lane per axis. A pair not proven apart counts as
// touching. The last block to end signals the host if it polls.
#include "cuda/engine/launch_kernel.cuh"
#include "cuda/engine/warp_double.cuh"
#include "cuda/paper/paper_kernels.hpp"

namespace axg::paper {
namespace {

using cuda::kWarp;

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 3;

/// Called by every block that had work, and always by the first one.
__device__ void signal_host(const ProveArguments& q, unsigned blocks) {
    __syncthreads();
    if (threadIdx.x != 0) {
        return;
    }
    __threadfence();  // this block's counts are visible before it is counted
    if (atomicAdd(&q.counters->done, 1U) + 1 != blocks || q.told == nullptr) {
        return;
    }
    __threadfence();
    for (unsigned i = 0; i < q.count; ++i) {
        const volatile Counters& from = q.counters[i];
        Counters& to = q.told->counts[i];
        to.touching = from.touching, to.tested = from.tested, to.left = from.left;
    }
    __threadfence_system();
    *static_cast<volatile std::uint32_t*>(&q.told->sequence) = q.sequence;
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    prove_left_kernel(const __grid_constant__ ProveArguments q) {
    cuda::wait_for_kernel_before();
    __shared__ cuda::PairVectors vectors[kWarps];
    const unsigned count = q.counters->listed, warp = threadIdx.x / kWarp;
    const unsigned blocks = max(1U, min(gridDim.x, count));  // that have work
    if (blockIdx.x >= blocks) {
        return;
    }
    // Every block gets one pair before any block gets a second.
    for (unsigned i = warp * gridDim.x + blockIdx.x; i < count; i += gridDim.x * kWarps) {
        const LeftPair at = q.left[i];
        const CertifiedPose& pose = q.pose[at.query];
        const Triangle a = q.a[at.query].triangles[at.a];
        const Triangle b = q.b[at.query].triangles[at.b];
        const Vec3f origin = origin_of(pose.pose, a);
        if (!left_is_apart_in_float(pose, a, b, origin) &&
            !cuda::warp_apart<false>(
                cuda::warp_pair(left_in_double(pose, a, b, origin), vectors[warp]), 0.0) &&
            cuda::lane_of_thread() == 0) {
            atomicAdd(&q.counters[at.query].touching, 1U);
        }
    }
    signal_host(q, blocks);
}

}  // namespace

cudaError_t launch_prove_left(const ProveArguments& arguments,
                              const cuda::Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return cuda::launch_kernel(prove_left_kernel, blocks, kThreads, launch, arguments);
}

KernelFacts facts_of_left() {
    return facts_of(reinterpret_cast<const void*>(&prove_left_kernel), "certified, what is left");
}

}  // namespace axg::paper
