// SPDX-License-Identifier: Apache-2.0
// Last kernel of a batch: one result a query into pinned memory, each with the batch's number
// and a check word, so that the host knows by each alone that it is whole. Far only where every
// list was long enough and everything listed was handled: a kernel that did not run shows here.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kThreads = kBatchQueriesMax;

/// Whether every pair of nodes that was listed was looked at, in trees that are as they were; and
/// whether no budget was left for one, or for a pair of triangles.
struct BatchState {
    bool is_complete, is_over, is_over_triangles;
};

__device__ BatchState state_of(const DeviceBuffers& b) {
    const Counters& counters = *b.counters;
    const BatchBudget& budget = counters.budget;
    const TreeSums& sums = b.sums;
    BatchState state{
        true, counters.leaf_listed > budget.leaf_pairs || counters.box_rows > budget.box_rows,
        counters.triangle_pairs > budget.triangle_pairs};
    for (std::uint32_t i = 0; i < kTreeLevelsMax; ++i) {
        const std::uint32_t most = tree_level_budget(b, i), listed = counters.listed[i];
        state.is_over = state.is_over || listed > most;
        state.is_complete = state.is_complete && counters.handled[i] == min(listed, most);
    }
    state.is_complete =
        state.is_complete && counters.leaf_handled == min(counters.leaf_listed, budget.leaf_pairs);
    const bool is_same =
        sums.found[counters.sequence % 2] == sums.wanted[counters.sequence % sums.slices];
    state.is_complete = state.is_complete && is_same;
    return state;
}

__device__ bool has_seen_all(const Tally& tally, const DeviceLimits& limits, QueryKind kind) {
    if (kind != QueryKind::clearance) {
        const std::uint32_t wanted = rechecks_wanted(tally, limits);
        return wanted == 0 || tally.recheck_budget == kBudgetRefused ||
               (tally.recheck_budget == kBudgetGiven && tally.recheck_done == wanted);
    }
    const std::uint32_t candidates = min(tally.candidates, limits.candidates);
    return tally.candidates_done[0] == candidates && tally.candidates_done[1] == candidates &&
           tally.candidates_done[2] == candidates;
}

__device__ QueryStatus status_of(const Tally& tally, const DeviceLimits& limits,
                                 const BatchState& state, QueryKind kind) {
    if (!state.is_complete || !has_seen_all(tally, limits, kind)) {
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
    const QueryStatus status = status_of(tally, b.limits, state, q.kind);
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

/// What is left of a budget.
__device__ std::uint32_t left_of(std::uint32_t budget, std::uint32_t used) {
    return budget - min(budget, used);
}

/// What the batch leaves for the next one of its cycle. `rechecks`: that its budget held.
__device__ void leave_budget(const DeviceBuffers& b, std::uint32_t rechecks) {
    const Counters& counters = *b.counters;
    const BatchBudget& budget = counters.budget;
    std::uint32_t level_pairs = 0;
    for (std::uint32_t i = 1; i < kTreeLevelsMax; ++i) {
        level_pairs = max(level_pairs, counters.listed[i]);
    }
    *b.cycle_budget = {left_of(budget.level_pairs, level_pairs),
                       left_of(budget.leaf_pairs, counters.leaf_listed),
                       left_of(budget.box_rows, counters.box_rows),
                       left_of(budget.triangle_pairs, counters.triangle_pairs),
                       left_of(budget.rechecks, rechecks)};
}

__global__ void __launch_bounds__(kThreads)
    write_results_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ std::uint32_t rechecks;
    const Counters& counters = *b.counters;
    if (threadIdx.x == 0) {
        rechecks = 0;
    }
    __syncthreads();
    const BatchState state = state_of(b);
    for (std::uint32_t i = threadIdx.x; i < counters.count; i += kThreads) {
        b.results[i] = result_of(b, i, state);
        const Tally& tally = b.tallies[i];
        if (tally.recheck_budget == kBudgetGiven) {
            atomicAdd(&rechecks, rechecks_wanted(tally, b.limits));
        }
    }
    __syncthreads();
    if (threadIdx.x == 0) {
        b.sums.found[(counters.sequence + 1) % 2] = 0;
        if (!b.limits.measures) {
            leave_budget(b, rechecks);
        }
    }
}

}  // namespace

cudaError_t launch_write_results(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    return launch_kernel(write_results_kernel, 1, kThreads, launch, buffers);
}

}  // namespace axg::cuda
