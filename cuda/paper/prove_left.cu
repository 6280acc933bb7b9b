// SPDX-License-Identifier: Apache-2.0
// What the first certified stage left: each axis by itself in float, then in double, a thread a
// pair. What nothing proves apart counts as touching.
#include "cuda/paper/paper_kernels.hpp"

namespace axg::paper {
namespace {

constexpr unsigned kThreads = 64, kBlocksPerMultiprocessor = 4;

__global__ void __launch_bounds__(kThreads)
    prove_left_kernel(const __grid_constant__ ProveArguments q) {
    const unsigned count = q.counters->listed;
    for (unsigned i = blockIdx.x * kThreads + threadIdx.x; i < count; i += gridDim.x * kThreads) {
        const LeftPair at = q.left[i];
        const CertifiedPose& pose = q.pose[at.question];
        const Triangle a = q.a[at.question].triangles[at.a];
        const Triangle b = q.b[at.question].triangles[at.b];
        if (!left_is_apart(pose, a, b, origin_of(pose.pose, a))) {
            atomicAdd(&q.counters[at.question].touching, 1U);
        }
    }
}

}  // namespace

cudaError_t launch_prove_left(const ProveArguments& arguments, unsigned multiprocessors,
                              cudaStream_t stream) noexcept {
    prove_left_kernel<<<multiprocessors * kBlocksPerMultiprocessor, kThreads, 0, stream>>>(
        arguments);
    return cudaGetLastError();
}

KernelFacts facts_of_left() {
    return facts_of(reinterpret_cast<const void*>(&prove_left_kernel), "certified, what is left");
}

}  // namespace axg::paper
