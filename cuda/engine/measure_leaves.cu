// SPDX-License-Identifier: Apache-2.0
// Clearance: pairs of leaves, one block per pair. Computes the certified distance in float of every
// pair of triangles whose boxes may be nearer than the bound. A pair whose distance is below the
// bound is a candidate.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 3;

/// One block's tile.
struct Tile {
    float a[9][kNodeWidth], b[9][kNodeWidth];  // less the common origin
    TightBox tight[kNodeWidth];                // of a's triangles
    float low[kLeafPairs];                     // bounds of the pairs, mm
    std::uint16_t pairs[kLeafPairs];           // place in a, place in b: five bits each
    float d;                                   // of scale_of
    std::uint32_t count, before, batch_before;
};

/// The first warp moves the leaf of a, the second that of b.
__device__ void move_leaves(const PreparedQuery& q, const TreeNode& a, const TreeNode& b,
                            const float* origin, Tile& tile) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    if (warp == 0) {
        const MovedCentres to = move_centres<false>(q, a.box.c, nullptr, origin);
        float v[9];
        tile.tight[lane] = move_triangle(q.c.a_in_b, a.box.c, to.a, q.a.leaves[a.leaf], lane, v);
        for (int k = 0; k < 9; ++k) {
            tile.a[k][lane] = v[k];
        }
        if (lane == 0) {
            tile.count = 0;
            tile.d = leaf_d(q.c.d32, a.box);
        }
    } else if (warp == 1) {
        for (int k = 0; k < 9; ++k) {
            tile.b[k][lane] = q.b.leaves[b.leaf].v[k][lane] - origin[k % 3];
        }
    }
}

/// Stores in the tile the pairs of triangles whose boxes' bound is below `bound`: one lane per
/// triangle of a; the warps share the triangles of b. The bounds are those of nearest_triangles
/// (core/collision/traverse_clearance.inl).
__device__ void gather(const PreparedQuery& q, const PairEntry& at, double bound, Tile& tile) {
    const TreeNode& a = q.a.nodes[at.a];
    const TreeNode& b = q.b.nodes[at.b];
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
    move_leaves(q, a, b, own.c, tile);
    const ChildBox box_a = child_box(a, lane), box_b = child_box(b, lane);
    const float low_b = low_bound(q.c.a_in_b, own, box_b);
    const float low_a = low_bound(q.c.b_in_a, moved_box(q.c.b_in_a, b.box.c, b.box.h), box_a);
    std::uint32_t bits_b = ballot(lane < b.count && low_b < bound);
    __syncthreads();
    const TightBox tight = tile.tight[lane];
    for (unsigned n = 0; bits_b != 0; bits_b &= bits_b - 1, ++n) {
        if (n % kWarps != warp) {
            continue;
        }
        const unsigned j = lowest(bits_b);
        const ChildBox other = child_box(b, j);
        float square = 0;
        for (int k = 0; k < 3; ++k) {
            const float c = other.c[k] - own.c[k], h = other.h[k] + q.c.tight_slack;
            const float gap =
                lanes::max(lanes::max(tight.low[k] - (c + h), (c - h) - tight.high[k]), 0.0F);
            square = lanes::fma(gap, gap, square);
        }
        const float pair = lanes::sqrt(square) * (1.0F - 0x1p-21F);
        const float low = lanes::max(lanes::max(pair, at.low_mm),
                                     lanes::max(low_a, __shfl_sync(kAllLanes, low_b, j)));
        const bool wanted = lane < a.count && low < bound;
        const std::uint32_t bits = ballot(wanted);
        std::uint32_t place = 0;
        if (lane == 0 && bits != 0) {
            place = atomicAdd(&tile.count, static_cast<std::uint32_t>(__popc(bits)));
        }
        place = __shfl_sync(kAllLanes, place, 0) + rank_in(bits);
        if (wanted) {
            tile.pairs[place] = static_cast<std::uint16_t>(lane << 5U | j);
            tile.low[place] = low;
        }
    }
}

__device__ void measure(const DeviceBuffers& buffers, const PreparedQuery& q, const PairEntry& at,
                        double bound, const Tile& tile) {
    Tally& tally = buffers.tallies[at.query];
    const std::size_t row = std::size_t{at.query} * buffers.limits.candidates;
    for (unsigned i = threadIdx.x; i < tile.count; i += kThreads) {
        const unsigned place_a = tile.pairs[i] >> 5U, place_b = tile.pairs[i] & 31U;
        const auto p = float_pair(tile.a, place_a, tile.b, place_b, tile.d);
        const auto closest = sat::closest_direction(p, sat::axes_of(p));
        const float proven = sat::certified_distance(p, closest.direction);
        const float low = lanes::max(proven, tile.low[i]);
        if (!(low < bound)) {
            continue;
        }
        atomicMin(&tally.least_float, __float_as_uint(low));  // not negative: bits sort
        const std::uint32_t slot = atomicAdd(&tally.candidates, 1U);
        if (slot < buffers.limits.candidates) {
            buffers.candidates[row + slot] = {
                at.a, at.b, static_cast<std::uint8_t>(place_a), static_cast<std::uint8_t>(place_b),
                0,    low};
        }
    }
}

__device__ void judge(const DeviceBuffers& buffers, const PairEntry& at, Tile& tile) {
    const PreparedQuery& q = buffers.prepared[at.query];
    const double bound = buffers.tallies[at.query].bound_mm;
    if (!(at.low_mm < bound)) {
        return;
    }
    gather(q, at, bound, tile);
    __syncthreads();
    if (tile.count == 0) {
        return;
    }
    if (threadIdx.x == 0) {
        tile.before = atomicAdd(&buffers.tallies[at.query].triangle_pairs, tile.count);
    } else if (threadIdx.x == kWarp) {
        tile.batch_before = atomicAdd(&buffers.counters->triangle_pairs, tile.count);
    }
    __syncthreads();
    if (tile.before + tile.count <= buffers.limits.triangle_pairs &&  // or the query is lost
        tile.batch_before + tile.count <= buffers.limits.batch_triangle_pairs) {  // or the batch
        measure(buffers, q, at, bound, tile);
    }
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    measure_leaves_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ Tile tile;
    const std::uint32_t count = min(b.counters->leaf_listed, b.limits.leaf_pairs);
    std::uint32_t handled = 0;
    for (std::uint32_t i = blockIdx.x; i < count; i += gridDim.x) {
        const PairEntry at = b.leaves[i];
        if (b.prepared[at.query].kind != QueryKind::clearance) {
            continue;  // test_leaves handles those
        }
        ++handled;
        if (!is_over(b.tallies[at.query], kTreeLevelsMax - 1, b.limits.node_pairs)) {
            judge(b, at, tile);
            __syncthreads();
        }
    }
    if (threadIdx.x == 0 && handled != 0) {
        atomicAdd(&b.counters->leaf_handled, handled);
    }
}

}  // namespace

cudaError_t launch_measure_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(measure_leaves_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
