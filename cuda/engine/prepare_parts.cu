// SPDX-License-Identifier: Apache-2.0
// First kernel of a batch about parts of boxes: the numbers that they have in common from pinned
// memory, and each part's query from those. Queries of other kinds come behind the parts.
#include "cuda/engine/prepare.cuh"

namespace axg::cuda {
namespace {

constexpr std::uint32_t kTreesHere = 3;  // at a time
constexpr unsigned kTreeWords = kTreesHere * sizeof(QueryTree) / sizeof(uint4);
constexpr unsigned kRootWords = sizeof(TreeRoot) / sizeof(uint4);
static_assert(sizeof(QueryTree) % sizeof(uint4) == 0 && sizeof(TreeRoot) % sizeof(uint4) == 0);

struct Shared {
    uint4 trees[kTreeWords];
    uint4 roots[kThreads * kRootWords];
};

/// Some trees from the `first` on: all loads at once, for the bus takes a microsecond for each.
__device__ void load_trees(const DeviceBuffers& b, std::uint32_t first, Shared& shared) {
    constexpr unsigned kEach = (kTreeWords + kThreads - 1) / kThreads;
    const uint4* const from =
        reinterpret_cast<const uint4*>(b.query_trees + min(first, kQueryTreesMax - kTreesHere));
    uint4 loaded[kEach];
#pragma unroll
    for (unsigned i = 0; i < kEach; ++i) {
        loaded[i] = from[min(i * kThreads + threadIdx.x, kTreeWords - 1)];
    }
#pragma unroll
    for (unsigned i = 0; i < kEach; ++i) {
        shared.trees[min(i * kThreads + threadIdx.x, kTreeWords - 1)] = loaded[i];
    }
}

/// Roots of this block's parts.
__device__ void load_roots(const DeviceBuffers& b, std::uint32_t first, std::uint32_t count,
                           Shared& shared) {
    const uint4* const from = reinterpret_cast<const uint4*>(b.roots + first);
#pragma unroll
    for (unsigned i = 0; i < kRootWords; ++i) {
        const unsigned word = i * kThreads + threadIdx.x;
        if (word < count * kRootWords) {
            shared.roots[word] = from[word];
        }
    }
}

/// The part that this thread has, once its tree is there. Called by whole blocks.
__device__ void start_parts(const DeviceBuffers& b, const BatchHead& head, std::uint32_t first,
                            std::uint32_t parts, Shared& shared) {
    const std::uint32_t depth = min(head.depth, kTreeDepthOfParts);
    const std::uint32_t first_root = first >> depth;
    const std::uint32_t roots = ((min(first + kThreads, parts) - 1) >> depth) - first_root + 1;
    load_roots(b, first_root, roots, shared);
    __syncthreads();
    const TreeRoot* const here = reinterpret_cast<const TreeRoot*>(shared.roots);
    const QueryTree* const trees = reinterpret_cast<const QueryTree*>(shared.trees);
    const std::uint32_t index = first + threadIdx.x;
    const TreeRoot& root = here[min((index >> depth) - first_root, roots - 1)];
    const std::uint32_t last_tree = min(here[roots - 1].tree, kQueryTreesMax - 1U);
    std::uint32_t loaded = 0;  // the first trees are there
    for (;;) {
        const std::uint32_t place = min(root.tree, kQueryTreesMax - 1U) - loaded;
        if (index < parts && place < kTreesHere) {
            Query query{};
            const bool is_far =
                part_query(trees[place], root, depth, index & ((1U << depth) - 1), query);
            start(b, index, query, is_far, head.sequence);
        }
        if (last_tree < loaded + kTreesHere) {
            return;
        }
        loaded =
            min(max(loaded + kTreesHere, std::uint32_t{here[0].tree}), kQueryTreesMax - kTreesHere);
        __syncthreads();
        load_trees(b, loaded, shared);
        __syncthreads();
    }
}

__global__ void __launch_bounds__(kThreads, 8)
    prepare_parts_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ Shared shared;
    if (did_other_work(b)) {
        return;
    }
    load_trees(b, 0, shared);  // mostly there are no more
    const BatchHead head = *b.head;
    const std::uint32_t count = min(head.count, b.limits.queries), parts = min(head.parts, count);
    const std::uint32_t first = blockIdx.x * kThreads, index = first + threadIdx.x;
    if (first < parts) {
        start_parts(b, head, first, parts, shared);
    }
    if (index >= parts && index < count) {
        start(b, index, b.queries[index - parts], false, head.sequence);
    }
    if (blockIdx.x == 0 && threadIdx.x == 0) {
        start_counters(b, head);
    }
}

}  // namespace

cudaError_t launch_prepare_parts(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = query_blocks(buffers.limits) + kSumBlocks + 1;
    return launch_kernel(prepare_parts_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
