// SPDX-License-Identifier: Apache-2.0
// Last kernel of a batch: writes one result per query to pinned memory, each with the batch's
// number and a check word, so that the host can check each result by itself. A result is far only
// if no list overflowed and every listed entry was handled: a kernel that did not run is detected.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = 64;  // queries a block, and groups
static_assert(kTreeLevelsMax <= kWarp, "a lane a tree level");

/// Whether every listed pair of nodes was handled, in unchanged trees; whether the budget of pairs
/// of nodes, pairs of leaves or rows of boxes was exceeded; and that of pairs of triangles.
struct BatchState {
    bool is_complete, is_over, is_over_triangles;
};

/// Called by whole warps, so that all loads run in parallel.
__device__ BatchState state_of(const DeviceBuffers& b) {
    const Counters& counters = *b.counters;
    const BatchBudget& budget = counters.budget;
    const TreeSums& sums = b.sums;
    const bool is_same =
        sums.found[counters.sequence % 2] == sums.wanted[counters.sequence % sums.slices];
    const bool is_level = lane_of_thread() < kTreeLevelsMax;
    const std::uint32_t tree_level = is_level ? lane_of_thread() : 0;
    const std::uint32_t most = tree_level_budget(b, tree_level),
                        listed = counters.listed[tree_level],
                        handled = counters.handled[tree_level];
    const std::uint32_t leaf_listed = counters.leaf_listed, box_rows = counters.box_rows;
    const bool is_leaf_complete = counters.leaf_handled == min(leaf_listed, budget.leaf_pairs);
    const bool is_leaf_over = leaf_listed > budget.leaf_pairs || box_rows > budget.box_rows;
    const bool is_over_triangles = counters.triangle_pairs > budget.triangle_pairs;
    const bool is_level_complete = ballot(is_level && handled != min(listed, most)) == 0;
    const bool is_level_over = ballot(is_level && listed > most) != 0;
    return {is_level_complete && is_leaf_complete && is_same, is_level_over || is_leaf_over,
            is_over_triangles};
}

__device__ bool has_seen_all(const DeviceBuffers& b, std::uint32_t index, QueryKind kind) {
    const Tally& tally = b.tallies[index];
    const DeviceLimits& limits = b.limits;
    if (kind != QueryKind::clearance) {
        const std::uint32_t wanted = rechecks_wanted(b, index);
        return wanted == 0 || tally.recheck_budget == kBudgetRefused ||
               (tally.recheck_budget == kBudgetGiven && tally.recheck_done == wanted);
    }
    const std::uint32_t candidates = min(tally.candidates, limits.candidates);
    return tally.candidates_done[0] == candidates && tally.candidates_done[1] == candidates &&
           tally.candidates_done[2] == candidates;
}

__device__ QueryStatus status_of(const DeviceBuffers& b, std::uint32_t index,
                                 const BatchState& state) {
    const Tally& tally = b.tallies[index];
    const DeviceLimits& limits = b.limits;
    const PreparedQuery& q = b.prepared[index];
    const QueryKind kind = q.kind;
    const bool is_stale = limits.is_stage && b.groups[q.group].sequence != tally.sequence;
    if (!state.is_complete || is_stale || !has_seen_all(b, index, kind)) {
        return QueryStatus::not_run;
    }
    if (tally.refused != 0) {
        return QueryStatus::bad_query;
    }
    if (state.is_over || is_over(tally, kTreeLevelsMax - 1, limits.node_pairs)) {
        return QueryStatus::too_many_node_pairs;
    }
    if (state.is_over_triangles || tally.triangle_pairs > limits.triangle_pairs) {
        return QueryStatus::too_many_triangle_pairs;
    }
    if (is_lost(b, q, kLossOfRechecks)) {
        return status_of_loss(b.groups[q.group].lost);
    }
    if (tally.near != 0) {
        return QueryStatus::ok;
    }
    if (kind == QueryKind::clearance
            ? tally.candidates > limits.candidates
            : tally.rechecks > limits.rechecks || tally.recheck_budget == kBudgetRefused) {
        return QueryStatus::too_many_rechecks;
    }
    return QueryStatus::ok;
}

__device__ void write_clearance(const Tally& tally, const PreparedQuery& q, DeviceResult& result) {
    const unsigned long long least = min(tally.least_first, tally.least_second);
    const double best = __builtin_bit_cast(double, least);
    result.clearance_mm = best > 0 ? best : 0;
    result.proof = static_cast<std::uint32_t>(best > 0 ? Proof::far : Proof::not_proven);
    if (best < q.r_mm) {
        result.nearest_a = static_cast<std::uint32_t>(tally.nearest >> 32U);
        result.nearest_b = static_cast<std::uint32_t>(tally.nearest);
    }
}

__device__ DeviceResult result_of(const DeviceBuffers& b, std::uint32_t index,
                                  const BatchState& state) {
    const Tally& tally = b.tallies[index];
    const PreparedQuery& q = b.prepared[index];
    DeviceResult result{};
    result.sequence = tally.sequence;
    const QueryStatus status = status_of(b, index, state);
    result.status = static_cast<std::uint32_t>(status);
    if (tally.refused == 0) {
        for (const std::uint32_t pairs : tally.pairs_at) {
            result.node_pairs += pairs;
        }
        result.triangle_pairs = tally.triangle_pairs;
        result.rechecks = q.kind == QueryKind::clearance ? tally.candidates : tally.rechecks;
    }
    if (status == QueryStatus::ok && q.kind == QueryKind::clearance) {
        write_clearance(tally, q, result);
    } else if (status == QueryStatus::ok) {
        const std::uint32_t touching = tally.near != 0 ? 1 : tally.touching;
        result.touching = q.kind == QueryKind::farther ? min(touching, 1U) : touching;
        result.proof = static_cast<std::uint32_t>(touching == 0 ? Proof::far : Proof::not_proven);
    }
    result.check = check_of(result);
    return result;
}

/// The work of one group of a stage.
__device__ DeviceGroupResult group_result_of(const GroupSums& group) {
    DeviceGroupResult result{};
    result.sequence = group.sequence;
    result.lost = group.lost;
    for (unsigned i = 0; i < kWorkListCount; ++i) {
        result.used[i] = group.used[i];
    }
    result.check = check_of(result);
    return result;
}

__global__ void __launch_bounds__(kThreads)
    write_results_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    const Counters& counters = *b.counters;
    const std::uint32_t i = blockIdx.x * kThreads + threadIdx.x;
    const BatchState state = state_of(b);
    if (i < counters.count) {
        b.results[i] = result_of(b, i, state);
    }
    if (b.limits.is_stage && i < min(counters.groups, b.limits.queries)) {
        b.groups_out[i] = group_result_of(b.groups[i]);
    }
    if (i == 0) {  // zeroes the next batch's sum; this kernel reads the other one
        b.sums.found[(counters.sequence + 1) % 2] = 0;
    }
}

}  // namespace

cudaError_t launch_write_results(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = (buffers.limits.queries + kThreads - 1) / kThreads;
    return launch_kernel(write_results_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
