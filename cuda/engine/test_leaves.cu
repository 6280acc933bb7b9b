// SPDX-License-Identifier: Apache-2.0
// Pairs of leaves, a warp a pair: moves both leaves once, drops the triangles whose tight boxes are
// apart and gathers what is left. Then the warps of a block share what its four pairs of leaves
// left, 32 pairs of triangles at a time: the certified test, a thread a pair. What float cannot
// settle goes to the query's list for the recheck.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 4;

/// One warp's room.
struct Room {
    float a[9][kNodeWidth], b[9][kNodeWidth];  // less the common origin
    std::uint16_t pairs[kLeafPairs];           // place in a, place in b: five bits each
    PairEntry at;
    std::uint32_t count;    // of the pairs; 0 where they are not to be tested
    std::uint32_t handled;  // pairs of leaves
    std::uint32_t rows;     // of the batch, as far as this warp knows
};

struct Shared {
    Room rooms[kWarps];
    bool is_lost;  // the batch, as far as this block knows
};

/// Two leaves of one query; `origin` is what both are moved by.
struct Leaves {
    const TreeNode& a;
    const TreeNode& b;
    float origin[3];
};

/// One lane's triangle of either leaf: its own box, and that from its moved vertices.
struct Clipped {
    TightBox tight_a, tight_b;
    ChildBox box_a;
    bool near_a = false;       // as far as boxes of whole leaves tell
    std::uint32_t bits_b = 0;  // likewise, all lanes'
};

/// Moves both leaves into the room; what boxes of whole leaves leave of them. Called by whole
/// warps.
__device__ Clipped move_leaves(const Ready& q, const Leaves& l, Room& room) {
    const unsigned lane = lane_of_thread();
    const float slack = q.c.tight_slack, none[3] = {0, 0, 0};
    Clipped c;
    float v[9];
    c.tight_a = move_triangle(q.pose, l.origin, q.a.leaves[l.a.leaf], lane, v);
    for (int k = 0; k < 9; ++k) {
        room.a[k][lane] = v[k];
    }
    const TreeLeaf& leaf = q.b.leaves[l.b.leaf];
    c.tight_b = move_triangle(q.inverse, none, leaf, lane, nullptr);
    for (int k = 0; k < 9; ++k) {
        room.b[k][lane] = leaf.v[k][lane] - l.origin[k % 3];
    }
    const TightBox whole_a = whole_of(c.tight_a), whole_b = whole_of(c.tight_b);
    if (apart_from_tight(whole_a, l.b.box.c, l.b.box.h, l.origin, slack) ||
        apart_from_tight(whole_b, l.a.box.c, l.a.box.h, none, slack)) {
        return c;
    }
    c.box_a = child_box(l.a, lane);
    const ChildBox box_b = child_box(l.b, lane);
    c.near_a = lane < l.a.count && !apart_from_tight(whole_b, c.box_a.c, c.box_a.h, none, slack);
    c.bits_b =
        ballot(lane < l.b.count && !apart_from_tight(whole_a, box_b.c, box_b.h, l.origin, slack));
    c.bits_b = ballot(c.near_a) == 0 ? 0 : c.bits_b;
    return c;
}

__device__ __forceinline__ float from_lane(float value, unsigned lane) {
    return __shfl_sync(kAllLanes, value, static_cast<int>(lane));
}

/// Pairs of triangles whose tight boxes are not proven apart, into room.pairs: a lane a triangle of
/// a, the triangles of b in turn. Returns how many.
__device__ std::uint32_t clip(const Ready& q, const Leaves& l, const Clipped& c, Room& room) {
    const unsigned lane = lane_of_thread();
    const float slack = q.c.tight_slack, none[3] = {0, 0, 0};
    std::uint32_t count = 0;
    for (std::uint32_t left = c.bits_b; left != 0; left &= left - 1) {
        const unsigned j = lowest(left);
        const ChildBox other = child_box(l.b, j);
        TightBox tight;
        for (int k = 0; k < 3; ++k) {
            tight.low[k] = from_lane(c.tight_b.low[k], j);
            tight.high[k] = from_lane(c.tight_b.high[k], j);
        }
        const bool near = c.near_a &&
                          !apart_from_tight(c.tight_a, other.c, other.h, l.origin, slack) &&
                          !apart_from_tight(tight, c.box_a.c, c.box_a.h, none, slack);
        const std::uint32_t bits = ballot(near);
        if (near) {
            room.pairs[count + rank_in(bits)] = static_cast<std::uint16_t>(lane << 5U | j);
        }
        count += static_cast<std::uint32_t>(__popc(bits));
    }
    return count;
}

/// Counts what was found. Whether it may be tested: neither the query is lost, nor the batch.
__device__ bool has_room(const DeviceBuffers& buffers, std::uint32_t query, std::uint32_t count) {
    std::uint32_t before = 0;
    if (lane_of_thread() == 0) {
        before = atomicAdd(&buffers.tallies[query].triangle_pairs, count);
    } else if (lane_of_thread() == 1) {
        before = atomicAdd(&buffers.progress->triangle_pairs, count);
    }
    const DeviceLimits& limits = buffers.limits;
    return __shfl_sync(kAllLanes, before, 0) + count <= limits.triangle_pairs &&
           __shfl_sync(kAllLanes, before, 1) + count <= buffers.progress->room.triangle_pairs;
}

/// One pair of leaves, up to the pairs of triangles that are left of it. Called by whole warps;
/// the first lane gets the batch's rows of boxes so far.
__device__ std::uint32_t gather(const DeviceBuffers& buffers, Room& room) {
    const Ready& q = buffers.ready[room.at.query];
    const TreeNode& a = q.a.nodes[room.at.a];
    const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
    const Leaves l{a, q.b.nodes[room.at.b], {own.c[0], own.c[1], own.c[2]}};
    const Clipped clipped = move_leaves(q, l, room);
    std::uint32_t rows = 0;
    if (lane_of_thread() == 0 && clipped.bits_b != 0) {
        const auto more = static_cast<std::uint32_t>(__popc(clipped.bits_b));
        rows = atomicAdd(&buffers.progress->box_rows, more) + more;
    }
    const std::uint32_t count = clip(q, l, clipped, room);
    if (count != 0 && has_room(buffers, room.at.query, count) && lane_of_thread() == 0) {
        room.count = count;
    }
    return rows;
}

/// The certified test of one pair of triangles.
__device__ void test(const DeviceBuffers& buffers, const Room& room, unsigned i) {
    const Ready& q = buffers.ready[room.at.query];
    const sat::PairLimits<float> limits{q.c.d32, q.c.margin, q.c.r_square};
    const unsigned place_a = room.pairs[i] >> 5U, place_b = room.pairs[i] & 31U;
    const Vertices v = vertices_of(room.a, place_a, room.b, place_b);
    float edges_square = 0;
    const bool apart = q.c.has_margin ? sat::apart<true>(v.a, v.b, limits, &edges_square)
                                      : sat::apart<false>(v.a, v.b, limits);
    if (apart) {
        return;
    }
    // Which query is read anew: its address in registers over the whole test is one too many for
    // compute capability 11.0.
    const Ready& again = buffers.ready[*static_cast<const volatile std::uint32_t*>(&room.at.query)];
    const bool is_near =
        again.c.has_margin &&
        sat::certified_within(sat::scaled_pair(v.a, v.b, again.c.d32), edges_square, again.near_mm);
    if (is_near && again.kind == QueryKind::farther) {
        // Settled, whatever else is found; that all of this kernel's pairs are counted before
        // anyone looks keeps the work independent of the order.
        atomicOr(&buffers.tallies[room.at.query].near, 1U);
        return;
    }
    const std::uint32_t slot = atomicAdd(&buffers.tallies[room.at.query].rechecks, 1U);
    if (slot < buffers.limits.rechecks) {
        const std::size_t row = std::size_t{room.at.query} * buffers.limits.rechecks;
        buffers.rechecks[row + slot] = {room.at.a,
                                        room.at.b,
                                        static_cast<std::uint8_t>(place_a),
                                        static_cast<std::uint8_t>(place_b),
                                        static_cast<std::uint16_t>(is_near ? 1 : 0),
                                        0};
    }
}

/// What the block's rooms hold, dealt out to its warps 32 at a time.
__device__ void test_rooms(const DeviceBuffers& buffers, const Shared& shared) {
    const unsigned warp = threadIdx.x / kWarp;
    unsigned dealt = 0;
#pragma unroll 1
    for (const Room& room : shared.rooms) {
        const unsigned shares = (room.count + kWarp - 1) / kWarp;
#pragma unroll 1
        for (unsigned n = (warp + kWarps - dealt) % kWarps; n < shares; n += kWarps) {
            const unsigned i = n * kWarp + lane_of_thread();
            if (i < room.count) {
                test(buffers, room, i);
            }
        }
        dealt = (dealt + shares) % kWarps;
    }
}

/// Whether this warp's pair of leaves, the i-th of the batch, is to be looked at. Counts it.
__device__ bool take(const DeviceBuffers& b, std::uint32_t i, std::uint32_t count, Room& room) {
    if (i >= count) {
        return false;
    }
    const PairEntry at = b.leaves[i];
    if (b.ready[at.query].kind == QueryKind::clearance) {
        return false;  // measure_leaves handles those
    }
    if (lane_of_thread() == 0) {
        room.at = at;
        ++room.handled;
    }
    __syncwarp();
    return !is_over(b.tallies[at.query], kTreeLevelsMax - 1, b.limits.node_pairs);
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    test_leaves_kernel(const __grid_constant__ DeviceBuffers b) {
    wait_for_kernel_before();
    __shared__ Shared shared;
    const unsigned warp = threadIdx.x / kWarp;
    Room& room = shared.rooms[warp];
    const std::uint32_t count = min(b.progress->leaf_listed, b.progress->room.leaf_pairs);
    if (lane_of_thread() == 0) {
        room.handled = 0;
        room.rows = 0;
    }
    if (threadIdx.x == 0) {
        shared.is_lost = false;
    }
    // One to every block before any block gets a second.
    for (std::uint32_t base = blockIdx.x; base < count; base += kWarps * gridDim.x) {
        if (lane_of_thread() == 0) {
            room.count = 0;
        }
        __syncthreads();
        // Rows beyond the limit: the whole batch is not proven, whatever is left out here.
        const bool is_lost = shared.is_lost;
        if (take(b, base + warp * gridDim.x, count, room) && !is_lost) {
            const std::uint32_t rows = gather(b, room);
            if (lane_of_thread() == 0) {
                room.rows = rows;
            }
        }
        __syncthreads();
        if (threadIdx.x == 0) {
            for (const Room& other : shared.rooms) {
                shared.is_lost = shared.is_lost || other.rows > b.progress->room.box_rows;
            }
        }
        test_rooms(b, shared);
        __syncthreads();
    }
    if (lane_of_thread() == 0 && room.handled != 0) {
        atomicAdd(&b.progress->leaf_handled, room.handled);
    }
}

}  // namespace

cudaError_t launch_test_leaves(const DeviceBuffers& buffers, const Launch& launch) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(test_leaves_kernel, blocks, kThreads, launch, buffers);
}

}  // namespace axg::cuda
