// SPDX-License-Identifier: Apache-2.0
// First kernel of a batch: queries from pinned memory, their constants, zeroed counters, and one
// pair of roots a query. Beside it, blocks that sum up a slice of the trees.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64;  // queries a block
static_assert(kThreads == kSumThreads);
static_assert(sizeof(Query) % sizeof(uint4) == 0);

/// Whether the engine can run it at all; if so, `prepared` holds what it takes.
__device__ bool prepare(const DeviceBuffers& b, const Query& q, PreparedQuery& prepared) {
    prepared.group = q.group;
    if (b.limits.is_stage && q.kind == QueryKind::clearance) {
        return false;  // its work is ordered by what was found
    }
    if (q.mesh_a >= b.limits.meshes || q.mesh_b >= b.limits.meshes || !usable(q)) {
        return false;
    }
    prepared.a = b.trees[q.mesh_a];
    prepared.b = b.trees[q.mesh_b];
    if (prepared.a.node_count == 0 || prepared.b.node_count == 0) {
        return false;
    }
    prepared.pose = q.pose;
    prepared.inverse = inverse(q.pose);
    prepared.kind = q.kind;
    prepared.is_float_only = q.is_float_only;
    prepared.r_mm = q.r_mm;
    prepared.wants_list = q.list.size() != 0;
    set_constants(prepared.c, q, prepared.a.reach_mm, prepared.b.reach_mm);
    prepared.near_mm = prepared.c.has_margin ? sat::near_limit(q.r_mm) : 0.0F;
    return true;
}

__device__ void start(const DeviceBuffers& b, std::uint32_t index, const Query& q,
                      std::uint32_t sequence) {
    Tally tally{};
    tally.sequence = sequence;
    tally.refused = prepare(b, q, b.prepared[index]) ? 0 : 1;
    // Nothing is nearer than 0 mm: a clearance up to there is known without a look.
    const bool has_work = tally.refused == 0 && (q.kind != QueryKind::clearance || q.r_mm > 0);
    tally.pairs_at[0] = has_work ? 1 : 0;
    tally.bound_mm = q.r_mm;
    tally.least_float = 0x7f800000U;
    tally.least_first = tally.least_second = __builtin_bit_cast(unsigned long long, q.r_mm);
    tally.nearest = ~0ULL;
    b.tallies[index] = tally;
    b.tree_level[0][index] = {has_work ? index : kNoQuery, 0, 0, 0};
}

/// This block's share of the sum over one slice of the trees.
__device__ void sum_trees(const TreeSums& sums, std::uint32_t block, std::uint32_t sequence) {
    const std::uint32_t slice = sequence % sums.slices;
    const uint4* const words =
        reinterpret_cast<const uint4*>(sums.words) + static_cast<std::size_t>(slice) * kSliceWords;
    unsigned long long sum = 0;
#pragma unroll
    for (unsigned i = 0; i < kSumLoads; ++i) {
        const std::uint32_t place = (i * kSumBlocks + block) * kSumThreads + threadIdx.x;
        const uint4 w = words[place];
        sum += sum_share(place, {w.x, w.y, w.z, w.w});
    }
    for (unsigned step = kWarp / 2; step != 0; step /= 2) {
        sum += __shfl_xor_sync(kAllLanes, sum, step);
    }
    if (lane_of_thread() == 0) {
        atomicAdd(&sums.found[sequence % 2], sum);
    }
}

/// Shares of a stage's groups, from pinned memory.
__device__ void copy_groups(const DeviceBuffers& b) {
    constexpr std::uint32_t kWords = sizeof(GroupSums) / sizeof(uint4);
    const std::uint32_t count = min(b.head->groups, b.limits.queries) * kWords;
    const uint4* const from = reinterpret_cast<const uint4*>(b.groups_in);
    uint4* const to = reinterpret_cast<uint4*>(b.groups);
    for (std::uint32_t i = threadIdx.x; i < count; i += kThreads) {
        to[i] = from[i];
    }
}

__global__ void __launch_bounds__(kThreads, 8)
    prepare_queries_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    // Through shared memory, so that the bus sees whole lines.
    constexpr unsigned kWords = kThreads * sizeof(Query) / sizeof(uint4);
    __shared__ uint4 words[kWords];
    const std::uint32_t query_blocks = (b.limits.queries + kThreads - 1) / kThreads;
    if (blockIdx.x == query_blocks + kSumBlocks) {
        copy_groups(b);
        return;
    }
    if (blockIdx.x >= query_blocks) {
        sum_trees(b.sums, blockIdx.x - query_blocks, b.head->sequence);
        return;
    }
    const std::uint32_t first = blockIdx.x * kThreads;
    const uint4* const from = reinterpret_cast<const uint4*>(b.queries + first);
    const std::uint32_t room = min(kThreads, b.limits.queries - first);
    constexpr unsigned kEach = kWords / kThreads;
    uint4 loaded[kEach];  // all on their way at once: the bus takes a microsecond for each
#pragma unroll
    for (unsigned i = 0; i < kEach; ++i) {
        loaded[i] = from[min(i * kThreads + threadIdx.x, room * kEach - 1)];
    }
    const BatchHead head = *b.head;
    const std::uint32_t sequence = head.sequence, count = min(head.count, b.limits.queries);
    if (first < count) {
        const std::uint32_t here = min(kThreads, count - first);
#pragma unroll
        for (unsigned i = 0; i < kEach; ++i) {
            words[i * kThreads + threadIdx.x] = loaded[i];
        }
        __syncthreads();
        if (threadIdx.x < here) {
            start(b, first + threadIdx.x, reinterpret_cast<const Query*>(words)[threadIdx.x],
                  sequence);
        }
    }
    if (blockIdx.x == 0 && threadIdx.x == 0) {
        const DeviceLimits& limits = b.limits;
        Counters counters{};
        counters.sequence = sequence;
        counters.count = count;
        counters.groups = head.groups;
        counters.budget = {limits.level_pairs, limits.leaf_pairs, limits.box_rows,
                           limits.batch_triangle_pairs, limits.batch_rechecks};
        counters.listed[0] = count;
        *b.counters = counters;
    }
}

}  // namespace

std::size_t prepared_query_size_bytes() noexcept {
    return sizeof(PreparedQuery);
}

cudaError_t launch_prepare_queries(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = (buffers.limits.queries + kThreads - 1) / kThreads + kSumBlocks +
                            (buffers.limits.is_stage ? 1U : 0U);
    return launch_kernel(prepare_queries_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
