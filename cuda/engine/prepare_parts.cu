// SPDX-License-Identifier: Apache-2.0
// First kernel of a batch that begins with parts of boxes: reads their common numbers from pinned
// memory and computes each part's query from them. Other queries follow the parts.
#include <cstddef>

#include "cuda/engine/prepare.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kParts = kPartsOfBlock;  // each is posed by a thread of either warp
static_assert(kParts == kWarp && kThreads == 2 * kWarp);
// Loaded before their counts: each read over the bus costs a microsecond, whatever its size.
constexpr std::uint32_t kRootsAtOnce = 4, kQueriesAtOnce = 2;
constexpr unsigned kTreeWords = sizeof(QueryTree) / sizeof(uint4);
constexpr unsigned kRootWords = sizeof(TreeRoot) / sizeof(uint4);
constexpr unsigned kQueryWords = kQueriesAtOnce * sizeof(Query) / sizeof(uint4);
static_assert(sizeof(QueryTree) % sizeof(uint4) == 0 && sizeof(TreeRoot) % sizeof(uint4) == 0);
constexpr unsigned kWordsAtOnce = kTreeWords + kRootsAtOnce * kRootWords;
static_assert(offsetof(PartBlock, roots) == sizeof(QueryTree));

struct Shared {
    uint4 trees[kRootsOfBlock * kTreeWords];
    uint4 roots[kRootsOfBlock * kRootWords];
    uint4 queries[kQueryWords];  // the first ones after the parts
    double left[12][kParts];     // the twelve numbers of the left half of each pose
};

/// Loads this block's first tree and first roots, all at once.
__device__ void load_first(const DeviceBuffers& b, Shared& shared) {
    const uint4* const from = reinterpret_cast<const uint4*>(
        b.part_blocks + min(blockIdx.x, part_blocks(b.limits.queries) - 1));
    constexpr unsigned kEach = (kWordsAtOnce + kThreads - 1) / kThreads;
    uint4 loaded[kEach];
#pragma unroll
    for (unsigned i = 0; i < kEach; ++i) {
        loaded[i] = from[min(i * kThreads + threadIdx.x, kWordsAtOnce - 1)];
    }
#pragma unroll
    for (unsigned i = 0; i < kEach; ++i) {
        const unsigned word = min(i * kThreads + threadIdx.x, kWordsAtOnce - 1);
        (word < kTreeWords ? shared.trees[word] : shared.roots[word - kTreeWords]) = loaded[i];
    }
}

/// Loads the other roots of this block.
__device__ void load_roots(const DeviceBuffers& b, std::uint32_t roots, Shared& shared) {
    const uint4* const from = reinterpret_cast<const uint4*>(b.part_blocks[blockIdx.x].roots);
    const unsigned first = kRootsAtOnce * kRootWords + threadIdx.x;
    for (unsigned word = first; word < roots * kRootWords; word += kThreads) {
        shared.roots[word] = from[word];
    }
}

/// Loads trees from the `first` one on, as many as a block can need.
__device__ void load_trees(const DeviceBuffers& b, std::uint32_t first, Shared& shared) {
    constexpr unsigned kWords = kRootsOfBlock * kTreeWords, kAtOnce = 8;
    const uint4* const from = reinterpret_cast<const uint4*>(b.query_trees + first);
    for (unsigned word = threadIdx.x; word < kWords; word += kAtOnce * kThreads) {
        uint4 loaded[kAtOnce];
#pragma unroll
        for (unsigned i = 0; i < kAtOnce; ++i) {
            loaded[i] = from[min(word + i * kThreads, kWords - 1)];
        }
#pragma unroll
        for (unsigned i = 0; i < kAtOnce; ++i) {
            shared.trees[min(word + i * kThreads, kWords - 1)] = loaded[i];
        }
    }
}

/// Loads the first queries after the parts, which this block may process.
__device__ void load_queries(const DeviceBuffers& b, Shared& shared) {
    static_assert(kQueryWords <= kThreads);
    if (threadIdx.x < kQueryWords) {
        shared.queries[threadIdx.x] = reinterpret_cast<const uint4*>(b.queries)[threadIdx.x];
    }
}

/// A pose is a product of two halves: the second warp computes the left ones, the first warp
/// computes the right ones and starts the queries. Called by whole blocks.
/// @param is_part  this thread has one
__device__ void pose_and_start(const DeviceBuffers& b, const Part& part, bool is_part,
                               std::uint32_t index, std::uint32_t sequence, Shared& shared) {
    const auto sines = [](double angle_rad) { return sin_cos(angle_rad); };
    const PoseProduct product = product_of(part.tree);
    const bool is_left = threadIdx.x >= kWarp;
    Pose half;
    if (is_part) {
        const std::uint32_t begin = is_left ? product.split : 0;
        const std::uint32_t end = is_left ? product.count : product.split;
        half = stretch_of(product, begin, end, part, sines);
    }
    if (is_part && is_left) {
        if (product.split != product.count) {
            half = compose(product.fixed[product.count], half);
        }
        for (int i = 0; i < 12; ++i) {
            shared.left[i][lane_of_thread()] = i < 9 ? half.r[i / 3][i % 3] : half.t[i - 9];
        }
    }
    __syncthreads();
    if (is_part && !is_left) {
        Query query{};
        const bool is_far = fill_query(part, query);
        query.pose = half;
        if (product.count != 0) {
            Pose left;
            for (int i = 0; i < 12; ++i) {
                const double number = shared.left[i][lane_of_thread()];
                (i < 9 ? left.r[i / 3][i % 3] : left.t[i - 9]) = number;
            }
            query.pose = compose(left, half);
        }
        start(b, index, query, is_far, sequence);
    }
}

/// Starts this block's parts. Called by whole blocks, after the first tree and roots are loaded.
__device__ void start_parts(const DeviceBuffers& b, const BatchHead& head, std::uint32_t first,
                            std::uint32_t parts, Shared& shared) {
    const TreeRoot* const here = reinterpret_cast<const TreeRoot*>(shared.roots);
    const QueryTree* const trees = reinterpret_cast<const QueryTree*>(shared.trees);
    const std::uint32_t depth = min(max(head.depth, 1U), kTreeDepthOfParts);
    const std::uint32_t first_root = first >> depth;
    const std::uint32_t roots = ((min(first + kParts, parts) - 1) >> depth) - first_root + 1;
    if (roots > kRootsAtOnce) {
        load_roots(b, min(roots, kRootsOfBlock), shared);
        __syncthreads();
    }
    std::uint32_t first_tree = min(std::uint32_t{here[0].tree}, kQueryTreesMax - 1);
    if (here[roots - 1].tree != here[0].tree) {  // else their only tree is loaded
        first_tree = min(first_tree, kQueryTreesMax - kRootsOfBlock);
        __syncthreads();
        load_trees(b, first_tree, shared);
        __syncthreads();
    }
    const std::uint32_t index = first + lane_of_thread();
    const TreeRoot& root = here[min((index >> depth) - first_root, roots - 1)];
    const QueryTree& tree = trees[min(root.tree - first_tree, kRootsOfBlock - 1)];
    pose_and_start(b, {tree, root, depth, index & ((1U << depth) - 1)}, index < parts, index,
                   head.sequence, shared);
}

__global__ void __launch_bounds__(kThreads, 8)
    prepare_parts_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ Shared shared;
    if (did_other_work(b, part_blocks(b.limits.queries))) {
        return;
    }
    const BatchHead head = *b.head;
    load_queries(b, shared);
    load_first(b, shared);
    __syncthreads();
    const std::uint32_t count = min(head.count, b.limits.queries), parts = min(head.parts, count);
    const std::uint32_t first = blockIdx.x * kParts, index = first + threadIdx.x;
    if (first < parts) {
        start_parts(b, head, first, parts, shared);
    }
    if (threadIdx.x < kParts && index >= parts && index < count) {
        const std::uint32_t place = index - parts;
        const Query* const here = reinterpret_cast<const Query*>(shared.queries);
        start(b, index, place < kQueriesAtOnce ? here[place] : b.queries[place], false,
              head.sequence);
    }
    if (blockIdx.x == 0 && threadIdx.x == 0) {
        start_counters(b, head);
    }
}

}  // namespace

cudaError_t launch_prepare_parts(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = part_blocks(buffers.limits.queries) + kSumBlocks + 1;
    return launch_kernel(prepare_parts_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
