// SPDX-License-Identifier: Apache-2.0
// First kernel of a batch: reads queries from pinned memory.
#include "cuda/engine/prepare.cuh"

namespace axg::cuda {
namespace {

static_assert(sizeof(Query) % sizeof(uint4) == 0);

/// Blocks with one thread per query.
[[nodiscard]] AXG_HD unsigned query_blocks(const DeviceLimits& limits) {
    return (limits.queries + kThreads - 1) / kThreads;
}

__global__ void __launch_bounds__(kThreads, 8)
    prepare_queries_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    // Through shared memory, so that the bus transfers whole lines.
    constexpr unsigned kWords = kThreads * sizeof(Query) / sizeof(uint4);
    __shared__ uint4 words[kWords];
    if (did_other_work(b, query_blocks(b.limits))) {
        return;
    }
    const std::uint32_t first = blockIdx.x * kThreads;
    const uint4* const from = reinterpret_cast<const uint4*>(b.queries + first);
    const std::uint32_t room = min(kThreads, b.limits.queries - first);
    constexpr unsigned kEach = kWords / kThreads;
    uint4 loaded[kEach];  // loads run in parallel: each needs a microsecond on the bus
#pragma unroll
    for (unsigned i = 0; i < kEach; ++i) {
        loaded[i] = from[min(i * kThreads + threadIdx.x, room * kEach - 1)];
    }
    const BatchHead head = *b.head;
    const std::uint32_t count = min(head.count, b.limits.queries);
    if (first < count) {
        const std::uint32_t here = min(kThreads, count - first);
#pragma unroll
        for (unsigned i = 0; i < kEach; ++i) {
            words[i * kThreads + threadIdx.x] = loaded[i];
        }
        __syncthreads();
        if (threadIdx.x < here) {
            start(b, first + threadIdx.x, reinterpret_cast<const Query*>(words)[threadIdx.x], false,
                  head.sequence);
        }
    }
    if (blockIdx.x == 0 && threadIdx.x == 0) {
        start_counters(b, head);
    }
}

}  // namespace

std::size_t prepared_query_size_bytes() noexcept {
    return sizeof(PreparedQuery);
}

cudaError_t launch_prepare_queries(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks =
        query_blocks(buffers.limits) + kSumBlocks + (buffers.limits.is_stage ? 1U : 0U);
    return launch_kernel(prepare_queries_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
