// SPDX-License-Identifier: Apache-2.0
// Tests pairs of triangles that float could not decide again, in double of the un-rounded vertices,
// one warp per pair. A pair that remains undecided counts as touching.
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"
#include "cuda/engine/warp_double.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 3;

__device__ void note_touching(const DeviceBuffers& b, std::uint32_t query, const PreparedQuery& q,
                              const TriangleEntry& e) {
    atomicAdd(&b.tallies[query].touching, 1U);
    if (!q.wants_list) {
        return;
    }
    const std::uint32_t slot = atomicAdd(&b.tallies[query].listed, 1U);
    if (slot < b.limits.listed) {
        b.listed[std::size_t{query} * b.limits.listed + slot] = ids_of(q, e);
        __threadfence_system();  // in the host's memory before the result is
    }
}

__device__ void recheck(const DeviceBuffers& b, std::uint32_t query, std::uint32_t index,
                        PairVectors& vectors) {
    const PreparedQuery& q = b.prepared[query];
    Tally& tally = b.tallies[query];
    // One touching pair settles `farther`. The result and the bound of the work are the same
    // without this early return.
    const bool is_settled =
        q.kind == QueryKind::farther &&
        ballot(*static_cast<volatile std::uint32_t*>(&tally.touching) != 0) != 0;
    if (is_settled) {
        if (lane_of_thread() == 0) {
            atomicAdd(&tally.recheck_done, 1U);
        }
        return;
    }
    const TriangleEntry e = b.rechecks[std::size_t{query} * b.limits.rechecks + index];
    bool apart = false;
    if (e.is_near == 0) {
        const WarpPair w = warp_pair(double_pair_of(q, e), vectors);
        apart = q.c.has_margin ? warp_apart<true>(w, q.c.margin64) : warp_apart<false>(w, 0.0);
    }
    if (lane_of_thread() == 0) {
        if (!apart) {
            note_touching(b, query, q, e);
        }
        atomicAdd(&tally.recheck_done, 1U);
    }
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    recheck_pairs_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ std::uint32_t counts[kBatchQueriesMax];
    __shared__ PairVectors vectors[kWarps];
    deal(
        b.counters->count, b.counters->budget.rechecks, counts,
        [&b](std::uint32_t query) { return rechecks_wanted(b, query); },
        [&b](std::uint32_t query, bool fits) {
            b.tallies[query].recheck_budget = fits ? kBudgetGiven : kBudgetRefused;
        },
        [&b](std::uint32_t query, std::uint32_t index) {
            recheck(b, query, index, vectors[threadIdx.x / kWarp]);
        });
}

}  // namespace

cudaError_t launch_recheck_pairs(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(recheck_pairs_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
