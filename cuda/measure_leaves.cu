// SPDX-License-Identifier: Apache-2.0
// Clearance: pairs of leaves, a warp a pair. Every pair of triangles whose boxes may be nearer than
// the bound gets its certified distance in float; what that leaves below the bound is a candidate.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 3;

/// One warp's room.
struct Room {
    float a[9][kNodeWidth], b[9][kNodeWidth];  // less the common origin
    float low[kLeafPairs];                     // bounds of the pairs, mm
    std::uint16_t pairs[kLeafPairs];           // place in a, place in b: five bits each
};

/// Pairs of triangles whose boxes' bound is below `bound`, into the room; returns how many. The
/// bounds are those of nearest_triangles (core/walk_clearance.inl).
__device__ unsigned gather(const Ready& q, const PairEntry& at, double bound, Room& room) {
    const TreeNode& a = q.a.nodes[at.a];
    const TreeNode& b = q.b.nodes[at.b];
    const unsigned lane = lane_of_thread();
    const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
    const ChildBox box_a = child_box(a, lane), box_b = child_box(b, lane);
    const float low_b = low_bound(q.c.a_in_b, own, box_b);
    const float low_a = low_bound(q.c.b_in_a, moved_box(q.c.b_in_a, b.box.c, b.box.h), box_a);
    std::uint32_t bits_b = ballot(lane < b.count && low_b < bound);
    if (bits_b == 0) {
        return 0;
    }
    float v[9];
    const TightBox tight = move_triangle(q.pose, own.c, q.a.leaves[a.leaf], lane, v);
    for (int k = 0; k < 9; ++k) {
        room.a[k][lane] = v[k];
        room.b[k][lane] = q.b.leaves[b.leaf].v[k][lane] - own.c[k % 3];
    }
    unsigned count = 0;
    for (; bits_b != 0; bits_b &= bits_b - 1) {
        const unsigned j = lowest(bits_b);
        float square = 0;
        for (int k = 0; k < 3; ++k) {
            const float c = __shfl_sync(kAllLanes, box_b.c[k], j) - own.c[k];
            const float h = __shfl_sync(kAllLanes, box_b.h[k], j) + q.c.tight_slack;
            const float gap =
                lanes::max(lanes::max(tight.low[k] - (c + h), (c - h) - tight.high[k]), 0.0F);
            square = lanes::fma(gap, gap, square);
        }
        const float pair = lanes::sqrt(square) * (1.0F - 0x1p-21F);
        const float low = lanes::max(lanes::max(pair, at.low_mm),
                                     lanes::max(low_a, __shfl_sync(kAllLanes, low_b, j)));
        const bool wanted = lane < a.count && low < bound;
        const std::uint32_t bits = ballot(wanted);
        if (wanted) {
            const unsigned place = count + rank_in(bits);
            room.pairs[place] = static_cast<std::uint16_t>(lane << 5U | j);
            room.low[place] = low;
        }
        count += static_cast<unsigned>(__popc(bits));
    }
    __syncwarp();
    return count;
}

__device__ void measure(const DeviceBuffers& buffers, const Ready& q, const PairEntry& at,
                        double bound, const Room& room, unsigned count) {
    Tally& tally = buffers.tallies[at.question];
    const std::size_t row = std::size_t{at.question} * buffers.limits.candidates;
    for (unsigned i = lane_of_thread(); i < count; i += kWarp) {
        const unsigned place_a = room.pairs[i] >> 5U, place_b = room.pairs[i] & 31U;
        const auto p = float_pair(room.a, place_a, room.b, place_b, q.c.d32);
        const auto closest = sat::closest_direction(p, sat::axes_of(p));
        const float proven = sat::certified_distance(p, closest.direction);
        const float low = lanes::max(proven, room.low[i]);
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

__device__ void judge(const DeviceBuffers& buffers, const PairEntry& at, Room& room) {
    const Ready& q = buffers.ready[at.question];
    const double bound = buffers.tallies[at.question].bound_mm;
    const unsigned count = at.low_mm < bound ? gather(q, at, bound, room) : 0;
    if (count == 0) {
        return;
    }
    std::uint32_t before = 0;
    if (lane_of_thread() == 0) {
        before = atomicAdd(&buffers.tallies[at.question].triangle_pairs, count);
    }
    before = __shfl_sync(kAllLanes, before, 0);
    if (before + count <= buffers.limits.triangle_pairs) {  // or the question is lost
        measure(buffers, q, at, bound, room, count);
    }
}

__global__ void __launch_bounds__(kThreads)
    measure_leaves_kernel(const __grid_constant__ DeviceBuffers b) {
    __shared__ Room rooms[kWarps];
    const std::uint32_t count = min(b.progress->leaf_listed, b.limits.leaf_pairs);
    const unsigned warp = threadIdx.x / kWarp;
    std::uint32_t handled = 0;
    for (std::uint32_t i = warp * gridDim.x + blockIdx.x; i < count; i += gridDim.x * kWarps) {
        const PairEntry at = b.leaves[i];
        if (b.ready[at.question].ask != Ask::clearance) {
            continue;  // test_leaves handles those
        }
        ++handled;
        if (!is_over(b.tallies[at.question], kLevelsMax - 1, b.limits.node_pairs)) {
            judge(b, at, rooms[warp]);
            __syncwarp();
        }
    }
    if (lane_of_thread() == 0 && handled != 0) {
        atomicAdd(&b.progress->leaf_handled, handled);
    }
}

}  // namespace

cudaError_t launch_measure_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    measure_leaves_kernel<<<blocks, kThreads, 0, launch.stream>>>(buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
