// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves, a warp a pair: moves both leaves once, drops the triangles whose tight boxes are
// apart, gathers what is left and asks the certified test, a lane a pair of triangles. What float
// cannot settle goes to the question's list for the recheck.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 4;

/// One warp's room.
struct Room {
    float a[9][kNodeWidth], b[9][kNodeWidth];  // less the common origin
    std::uint16_t pairs[kLeafPairs];           // place in a, place in b: five bits each
};

/// Two leaves of one question.
struct Leaves {
    PairEntry at;
    const TreeNode& a;
    const TreeNode& b;
};

/// Pairs of triangles whose tight boxes are not proven apart, into room.pairs; returns how many.
__device__ unsigned clip(const Ready& q, const Leaves& l, Room& room) {
    const unsigned lane = lane_of_thread();
    const float slack = q.c.tight_slack, none[3] = {0, 0, 0};
    const Moved own = moved_box(q.c.a_in_b, l.a.box.c, l.a.box.h);
    float v[9];
    const TightBox tight_a = move_triangle(q.pose, own.c, q.a.leaves[l.a.leaf], lane, v);
    const TightBox whole_a = whole_of(tight_a);
    if (apart_from_tight(whole_a, l.b.box.c, l.b.box.h, own.c, slack)) {
        return 0;
    }
    const TreeLeaf& leaf_b = q.b.leaves[l.b.leaf];
    const TightBox tight_b = move_triangle(q.inverse, none, leaf_b, lane, nullptr);
    const TightBox whole_b = whole_of(tight_b);
    if (apart_from_tight(whole_b, l.a.box.c, l.a.box.h, none, slack)) {
        return 0;
    }
    const ChildBox box_a = child_box(l.a, lane), box_b = child_box(l.b, lane);
    const bool near_a =
        lane < l.a.count && !apart_from_tight(whole_b, box_a.c, box_a.h, none, slack);
    std::uint32_t bits_b =
        ballot(lane < l.b.count && !apart_from_tight(whole_a, box_b.c, box_b.h, own.c, slack));
    if (bits_b == 0 || ballot(near_a) == 0) {
        return 0;
    }
    for (int k = 0; k < 9; ++k) {
        room.a[k][lane] = v[k];
        room.b[k][lane] = leaf_b.v[k][lane] - own.c[k % 3];
    }
    unsigned count = 0;
    for (; bits_b != 0; bits_b &= bits_b - 1) {
        const unsigned j = lowest(bits_b);
        ChildBox other;
        TightBox tight;
        for (int k = 0; k < 3; ++k) {
            other.c[k] = __shfl_sync(kAllLanes, box_b.c[k], j);
            other.h[k] = __shfl_sync(kAllLanes, box_b.h[k], j);
            tight.low[k] = __shfl_sync(kAllLanes, tight_b.low[k], j);
            tight.high[k] = __shfl_sync(kAllLanes, tight_b.high[k], j);
        }
        const bool near = near_a && !apart_from_tight(tight_a, other.c, other.h, own.c, slack) &&
                          !apart_from_tight(tight, box_a.c, box_a.h, none, slack);
        const std::uint32_t bits = ballot(near);
        if (near) {
            room.pairs[count + rank_in(bits)] = static_cast<std::uint16_t>(lane << 5U | j);
        }
        count += static_cast<unsigned>(__popc(bits));
    }
    __syncwarp();
    return count;
}

template <bool kMargin>
__device__ void test(const DeviceBuffers& buffers, const Ready& q, const Leaves& l,
                     const Room& room, unsigned count) {
    Tally& tally = buffers.tallies[l.at.question];
    const sat::PairLimits<float> limits{q.c.d32, q.c.margin, q.c.r_square};
    for (unsigned i = lane_of_thread(); i < count; i += kWarp) {
        const unsigned place_a = room.pairs[i] >> 5U, place_b = room.pairs[i] & 31U;
        const Vertices v = vertices_of(room.a, place_a, room.b, place_b);
        if (sat::apart<kMargin>(v.a, v.b, limits)) {
            continue;
        }
        const std::uint32_t slot = atomicAdd(&tally.rechecks, 1U);
        if (slot < buffers.limits.rechecks) {
            const std::size_t row = std::size_t{l.at.question} * buffers.limits.rechecks;
            buffers.rechecks[row + slot] = {l.at.a,
                                            l.at.b,
                                            static_cast<std::uint8_t>(place_a),
                                            static_cast<std::uint8_t>(place_b),
                                            0,
                                            0};
        }
    }
}

__device__ void judge(const DeviceBuffers& buffers, const PairEntry& at, Room& room) {
    const Ready& q = buffers.ready[at.question];
    const Leaves l{at, q.a.nodes[at.a], q.b.nodes[at.b]};
    const unsigned count = clip(q, l, room);
    if (count == 0) {
        return;
    }
    std::uint32_t before = 0;
    if (lane_of_thread() == 0) {
        before = atomicAdd(&buffers.tallies[at.question].triangle_pairs, count);
    }
    before = __shfl_sync(kAllLanes, before, 0);
    if (before + count > buffers.limits.triangle_pairs) {
        return;  // the question is lost: no more work for it
    }
    if (q.c.has_margin) {
        test<true>(buffers, q, l, room, count);
    } else {
        test<false>(buffers, q, l, room, count);
    }
}

__global__ void __launch_bounds__(kThreads)
    test_leaves_kernel(const __grid_constant__ DeviceBuffers b) {
    __shared__ Room rooms[kWarps];
    const std::uint32_t count = min(b.progress->leaf_listed, b.limits.leaf_pairs);
    const unsigned warp = threadIdx.x / kWarp;
    std::uint32_t handled = 0;
    for (std::uint32_t i = warp * gridDim.x + blockIdx.x; i < count; i += gridDim.x * kWarps) {
        const PairEntry at = b.leaves[i];
        if (b.ready[at.question].ask == Ask::clearance) {
            continue;  // measure_leaves handles those
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

cudaError_t launch_test_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    test_leaves_kernel<<<blocks, kThreads, 0, launch.stream>>>(buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
