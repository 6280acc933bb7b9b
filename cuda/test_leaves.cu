// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves, a block a pair: moves both leaves once, drops the triangles whose tight boxes
// are apart, gathers what is left and asks the certified test, a thread a pair of triangles. What
// float cannot settle goes to the question's list for the recheck.
#include "cuda/device_walk.cuh"
#include "cuda/kernels.hpp"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 4;

/// One block's room.
struct Room {
    float a[9][kNodeWidth], b[9][kNodeWidth];  // less the common origin
    TightBox tight_a[kNodeWidth], tight_b[kNodeWidth];
    TightBox whole_a, whole_b;
    std::uint16_t pairs[kLeafPairs];  // place in a, place in b: five bits each
    std::uint32_t count, before;
};

/// Two leaves of one question; `origin` is what both are moved by.
struct Leaves {
    PairEntry at;
    const TreeNode& a;
    const TreeNode& b;
    float origin[3];
};

/// The first warp moves the leaf of a, the second that of b.
__device__ void move_leaves(const Ready& q, const Leaves& l, Room& room) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    if (warp == 0) {
        float v[9];
        const TightBox own = move_triangle(q.pose, l.origin, q.a.leaves[l.a.leaf], lane, v);
        const TightBox whole = whole_of(own);
        for (int k = 0; k < 9; ++k) {
            room.a[k][lane] = v[k];
        }
        room.tight_a[lane] = own;
        if (lane == 0) {
            room.whole_a = whole;
            room.count = 0;
        }
    } else if (warp == 1) {
        const float none[3] = {0, 0, 0};
        const TreeLeaf& leaf = q.b.leaves[l.b.leaf];
        const TightBox own = move_triangle(q.inverse, none, leaf, lane, nullptr);
        const TightBox whole = whole_of(own);
        for (int k = 0; k < 9; ++k) {
            room.b[k][lane] = leaf.v[k][lane] - l.origin[k % 3];
        }
        room.tight_b[lane] = own;
        if (lane == 0) {
            room.whole_b = whole;
        }
    }
}

/// Pairs of triangles whose tight boxes are not proven apart, into room.pairs: a lane a triangle of
/// a, the triangles of b dealt out to the warps.
__device__ void clip(const Ready& q, const Leaves& l, Room& room) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    const float slack = q.c.tight_slack, none[3] = {0, 0, 0};
    if (apart_from_tight(room.whole_a, l.b.box.c, l.b.box.h, l.origin, slack) ||
        apart_from_tight(room.whole_b, l.a.box.c, l.a.box.h, none, slack)) {
        return;
    }
    const ChildBox box_a = child_box(l.a, lane), box_b = child_box(l.b, lane);
    const bool near_a =
        lane < l.a.count && !apart_from_tight(room.whole_b, box_a.c, box_a.h, none, slack);
    std::uint32_t bits_b = ballot(
        lane < l.b.count && !apart_from_tight(room.whole_a, box_b.c, box_b.h, l.origin, slack));
    if (ballot(near_a) == 0) {
        return;
    }
    const TightBox tight_a = room.tight_a[lane];
    for (unsigned n = 0; bits_b != 0; bits_b &= bits_b - 1, ++n) {
        if (n % kWarps != warp) {
            continue;
        }
        const unsigned j = lowest(bits_b);
        const ChildBox other = child_box(l.b, j);
        const bool near = near_a && !apart_from_tight(tight_a, other.c, other.h, l.origin, slack) &&
                          !apart_from_tight(room.tight_b[j], box_a.c, box_a.h, none, slack);
        const std::uint32_t bits = ballot(near);
        std::uint32_t place = 0;
        if (lane == 0 && bits != 0) {
            place = atomicAdd(&room.count, static_cast<std::uint32_t>(__popc(bits)));
        }
        place = __shfl_sync(kAllLanes, place, 0) + rank_in(bits);
        if (near) {
            room.pairs[place] = static_cast<std::uint16_t>(lane << 5U | j);
        }
    }
}

template <bool kMargin>
__device__ void test(const DeviceBuffers& buffers, const Ready& q, const Leaves& l,
                     const Room& room) {
    Tally& tally = buffers.tallies[l.at.question];
    const sat::PairLimits<float> limits{q.c.d32, q.c.margin, q.c.r_square};
    for (unsigned i = threadIdx.x; i < room.count; i += kThreads) {
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
    const TreeNode& a = q.a.nodes[at.a];
    const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
    const Leaves l{at, a, q.b.nodes[at.b], {own.c[0], own.c[1], own.c[2]}};
    move_leaves(q, l, room);
    __syncthreads();
    clip(q, l, room);
    __syncthreads();
    if (room.count == 0) {
        return;
    }
    if (threadIdx.x == 0) {
        room.before = atomicAdd(&buffers.tallies[at.question].triangle_pairs, room.count);
    }
    __syncthreads();
    if (room.before + room.count > buffers.limits.triangle_pairs) {
        return;  // the question is lost: no more work for it
    }
    if (q.c.has_margin) {
        test<true>(buffers, q, l, room);
    } else {
        test<false>(buffers, q, l, room);
    }
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    test_leaves_kernel(const __grid_constant__ DeviceBuffers b) {
    __shared__ Room room;
    const std::uint32_t count = min(b.progress->leaf_listed, b.limits.leaf_pairs);
    std::uint32_t handled = 0;
    for (std::uint32_t i = blockIdx.x; i < count; i += gridDim.x) {
        const PairEntry at = b.leaves[i];
        if (b.ready[at.question].ask == Ask::clearance) {
            continue;  // measure_leaves handles those
        }
        ++handled;
        if (!is_over(b.tallies[at.question], kLevelsMax - 1, b.limits.node_pairs)) {
            judge(b, at, room);
            __syncthreads();
        }
    }
    if (threadIdx.x == 0 && handled != 0) {
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
