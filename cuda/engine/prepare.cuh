// SPDX-License-Identifier: Apache-2.0
// The part that both first kernels of a batch share: computes the constants of the queries, zeroes
// counters and lists one pair of roots per query. Further blocks sum up a slice of the trees.
#pragma once

#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"
#include "cuda/engine/prepare_query.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64;
static_assert(kThreads == kSumThreads);

/// Whether the engine can run the query; if so, fills `prepared`.
__device__ bool prepare(const DeviceBuffers& b, const Query& q, PreparedQuery& prepared) {
    prepared.group = q.group;
    // The order of the work of a clearance depends on its findings.
    return !(b.limits.is_stage && q.kind == QueryKind::clearance) &&
           prepare_query(b.trees, b.limits.meshes, q, prepared);
}

/// Zeroes the tally of the query and lists its two roots.
/// @param is_far  proven without any work
__device__ void start(const DeviceBuffers& b, std::uint32_t index, const Query& q, bool is_far,
                      std::uint32_t sequence) {
    Tally tally{};
    tally.sequence = sequence;
    tally.refused = prepare(b, q, b.prepared[index]) ? 0 : 1;
    // No distance is below 0 mm: a clearance up to 0 mm needs no work.
    const bool has_work =
        tally.refused == 0 && !is_far && (q.kind != QueryKind::clearance || q.r_mm > 0);
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

/// Copies the shares of a stage's groups from pinned memory; loads the first before their count.
__device__ void copy_groups(const DeviceBuffers& b) {
    constexpr std::uint32_t kWords = sizeof(GroupSums) / sizeof(uint4);
    const uint4* const from = reinterpret_cast<const uint4*>(b.groups_in);
    uint4* const to = reinterpret_cast<uint4*>(b.groups);
    const uint4 first = from[min(threadIdx.x, b.limits.queries * kWords - 1)];
    const std::uint32_t count = min(b.head->groups, b.limits.queries) * kWords;
    if (threadIdx.x < count) {
        to[threadIdx.x] = first;
    }
    for (std::uint32_t i = kThreads + threadIdx.x; i < count; i += kThreads) {
        to[i] = from[i];
    }
}

/// Called by one thread of the batch.
__device__ void start_counters(const DeviceBuffers& b, const BatchHead& head) {
    const DeviceLimits& limits = b.limits;
    Counters counters{};
    counters.sequence = head.sequence;
    counters.count = min(head.count, limits.queries);
    counters.groups = head.groups;
    counters.budget = {limits.level_pairs, limits.leaf_pairs, limits.box_rows,
                       limits.batch_triangle_pairs, limits.batch_rechecks};
    counters.listed[0] = counters.count;
    *b.counters = counters;
}

/// Whether this block follows the `own` first ones. If so, it does the sums or the groups.
__device__ bool did_other_work(const DeviceBuffers& b, unsigned own) {
    if (blockIdx.x < own) {
        return false;
    }
    if (blockIdx.x == own + kSumBlocks) {
        copy_groups(b);
    } else {
        sum_trees(b.sums, blockIdx.x - own, b.head->sequence);
    }
    return true;
}

}  // namespace
}  // namespace axg::cuda
