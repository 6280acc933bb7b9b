// SPDX-License-Identifier: Apache-2.0
// Second kernel of an offline batch, a warp a query: descends both trees depth first with its own
// lists in shared memory, tests the pairs of triangles in float and, where float cannot decide, in
// double. Ends at the first pair that is not apart. The same tests of the same pairs as the other
// engines; a list that is full leaves the query to the CPU engine.
#include "cuda/engine/clip_leaves.cuh"
#include "cuda/engine/warp_double.cuh"
#include "cuda/offline/offline_kernels.hpp"
#include "cuda/offline/offline_prepared.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kBlocksPerMultiprocessor = 4;
constexpr std::uint32_t kOpenMax = 256;  // pairs of nodes that a query may have open at once

struct OpenPair {
    std::uint32_t a, b;
};

/// The row of a child of a: its moved box and, for the tight box of a leaf, its moved centre.
struct OfflineRow {
    Moved moved;
    float centre[3], origin[3], shift[3];
};

/// One warp's shared memory.
struct Room {
    OfflinePrepared prepared;
    OpenPair open[kOpenMax];
    std::uint32_t leaf_bits[kNodeWidth], leaf_of[kNodeWidth];  // by row
    std::uint8_t child[kNodeWidth];                            // of a, by row
    union {
        OfflineRow rows[kNodeWidth];
        MovedPair pair;
    };
    PairVectors vectors;
};
static_assert(sizeof(OfflinePrepared) % sizeof(uint4) == 0);

/// How a query goes on; the same in all lanes.
struct Progress {
    std::uint32_t open = 0;  // pairs of nodes
    std::uint32_t node_pairs = 0, triangle_pairs = 0, rechecks = 0;
    bool is_near = false, is_again = false;

    __device__ bool has_ended() const { return is_near || is_again; }
};

/// Opens the pairs of the lanes in `bits` next.
__device__ __forceinline__ void push(Room& room, Progress& at, std::uint32_t bits,
                                     std::uint32_t node_a, std::uint32_t node_b) {
    const auto more = static_cast<std::uint32_t>(__popc(bits));
    if (at.open + more > kOpenMax) {
        at.is_again = true;
        return;
    }
    if ((bits >> lane_of_thread() & 1U) != 0) {
        room.open[at.open + rank_in(bits)] = {node_a, node_b};
    }
    at.open += more;
}

/// Tests in double a pair of triangles that float could not decide. Called by whole warps.
__device__ __noinline__ bool is_apart_in_double(const PreparedQuery& q, std::uint32_t node_a,
                                                std::uint32_t node_b, unsigned places,
                                                PairVectors& vectors) {
    const TriangleEntry entry{node_a,
                              node_b,
                              static_cast<std::uint8_t>(places >> 5U),
                              static_cast<std::uint8_t>(places & 31U),
                              0,
                              0};
    const WarpPair w = warp_pair(double_pair_of(q, entry), vectors);
    return q.c.has_margin ? warp_apart<true>(w, q.c.margin64) : warp_apart<false>(w, 0.0);
}

/// Tests the first `count` pairs of triangles of the room's pair of leaves.
__device__ __forceinline__ void test_triangles(Room& room, Progress& at, std::uint32_t node_a,
                                               std::uint32_t node_b, std::uint32_t count) {
    const PreparedQuery& q = room.prepared.q;
    const MovedPair& pair = room.pair;
    const sat::PairLimits<float> limits{pair.d, q.c.margin, q.c.r_square};
    for (std::uint32_t first = 0; first < count && !at.has_ended(); first += kWarp) {
        const std::uint32_t i = first + lane_of_thread();
        bool is_open = false, is_near = false;
        if (i < count) {
            const LaneVertices<float> v = in_lane<float>(
                vertices_of(pair.a, pair.pairs[i] >> 5U, pair.b, pair.pairs[i] & 31U));
            float edges_square = 0;
            is_open = !(q.c.has_margin ? sat::apart<true>(v.a, v.b, limits, &edges_square)
                                       : sat::apart<false>(v.a, v.b, limits, &edges_square));
            is_near = is_open &&
                      (q.is_float_only ||
                       (q.c.has_margin && sat::certified_within(sat::scaled_pair(v.a, v.b, pair.d),
                                                                edges_square, q.near_mm)));
        }
        std::uint32_t left = ballot(is_open);
        if (ballot(is_near) != 0) {
            at.is_near = true;
            return;
        }
        at.rechecks += static_cast<std::uint32_t>(__popc(left));
        for (; left != 0 && !at.is_near; left &= left - 1) {
            at.is_near = !is_apart_in_double(q, node_a, node_b, pair.pairs[first + lowest(left)],
                                             room.vectors);
        }
    }
}

/// One pair of leaves.
__device__ __forceinline__ void test_leaves(const OfflineBuffers& b, Room& room, Progress& at,
                                            std::uint32_t node_a, std::uint32_t node_b) {
    const PreparedQuery& q = room.prepared.q;
    const TreeNode &a = q.a.nodes[node_a], &other = q.b.nodes[node_b];
    const Moved own = moved_box(q.c.a_in_b, a.box.c, a.box.h);
    const Leaves leaves{
        a, other, q.a.leaves[a.leaf], q.b.leaves[other.leaf], {own.c[0], own.c[1], own.c[2]}};
    const ClippedLeaf clipped = move_leaves(q, leaves, room.pair);
    const std::uint32_t count = clip(q, leaves, clipped, room.pair);
    __syncwarp();
    at.triangle_pairs += count;
    at.is_again = at.is_again || at.triangle_pairs > b.triangle_pairs;
    test_triangles(room, at, node_a, node_b, count);
    at.is_again = at.is_again || at.rechecks > b.rechecks;
    __syncwarp();  // before the next pair of leaves overwrites this one
}

/// Opens b alone (a is a leaf) or a alone (b is a leaf).
__device__ __forceinline__ void open_one(const OfflineBuffers& b, Room& room, Progress& at,
                                         const OpenPair& pair, const TreeNode& node_a,
                                         const TreeNode& node_b) {
    const PreparedQuery& q = room.prepared.q;
    const unsigned lane = lane_of_thread();
    const bool opens_b = is_leaf(node_a);
    const TreeNode& node = opens_b ? node_b : node_a;
    const Aabb& kept = opens_b ? node_a.box : node_b.box;
    const Frame& frame = opens_b ? q.c.a_in_b : q.c.b_in_a;
    const bool is_near_box =
        lane < node.count &&
        is_near<true>(frame, moved_box(frame, kept.c, kept.h), child_box(node, lane));
    const std::uint32_t bits = ballot(is_near_box), child = node.first_child + lane;
    const bool is_child_leaf =
        is_near_box && is_leaf(opens_b ? q.b.nodes[child] : q.a.nodes[child]);
    std::uint32_t leaves = ballot(is_child_leaf);
    at.node_pairs += static_cast<std::uint32_t>(__popc(bits));
    push(room, at, bits & ~leaves, opens_b ? pair.a : child, opens_b ? child : pair.b);
    for (; leaves != 0 && !at.has_ended(); leaves &= leaves - 1) {
        const std::uint32_t leaf = node.first_child + lowest(leaves);
        test_leaves(b, room, at, opens_b ? pair.a : leaf, opens_b ? leaf : pair.b);
    }
}

/// Stores the rows of the children of a that are near b's own box. Returns their number.
__device__ __forceinline__ std::uint32_t make_rows(Room& room, const TreeNode& node_a,
                                                   const TreeNode& node_b) {
    const PreparedQuery& q = room.prepared.q;
    const unsigned lane = lane_of_thread();
    const ChildBox own = child_box(node_a, lane);
    const bool is_row =
        lane < node_a.count &&
        is_near<true>(q.c.b_in_a, moved_box(q.c.b_in_a, node_b.box.c, node_b.box.h), own);
    const std::uint32_t bits = ballot(is_row);
    if (is_row) {
        const unsigned n = rank_in(bits);
        const TreeNode& child = q.a.nodes[node_a.first_child + lane];
        OfflineRow& row = room.rows[n];
        room.child[n] = static_cast<std::uint8_t>(lane);
        room.leaf_of[n] = child.leaf;
        row.moved = moved_box(q.c.a_in_b, own.c, own.h);
        if (is_leaf(child)) {
            const Moved moved = moved_box(q.c.a_in_b, child.box.c, child.box.h);
            for (int k = 0; k < 3; ++k) {
                row.centre[k] = child.box.c[k];
                row.origin[k] = moved.c[k];
                row.shift[k] = moved_centre(q.pose, k, child.box.c, moved.c[k]);
            }
        }
    }
    return static_cast<std::uint32_t>(__popc(bits));
}

/// Opens two inner nodes: each child of a against each child of b; then the pairs of leaves found.
__device__ __forceinline__ void open_both(const OfflineBuffers& b, Room& room, Progress& at,
                                          const TreeNode& node_a, const TreeNode& node_b) {
    const PreparedQuery& q = room.prepared.q;
    const unsigned lane = lane_of_thread();
    const ChildBox box = child_box(node_b, lane);
    const bool wanted =
        lane < node_b.count &&
        is_near<true>(q.c.a_in_b, moved_box(q.c.a_in_b, node_a.box.c, node_a.box.h), box);
    if (ballot(wanted) == 0) {
        return;
    }
    const std::uint32_t rows = make_rows(room, node_a, node_b);
    const std::uint32_t child_b = node_b.first_child + (lane < node_b.count ? lane : 0);
    const std::uint32_t leaves_b = ballot(lane < node_b.count && is_leaf(q.b.nodes[child_b]));
    __syncwarp();
    for (std::uint32_t n = 0; n < rows; ++n) {
        const OfflineRow& row = room.rows[n];
        const std::uint32_t leaf = room.leaf_of[n];
        bool near = wanted && is_near<false>(q.c.a_in_b, row.moved, box);
        if (ballot(near) != 0 && leaf != kNoLeaf) {
            const TightBox whole = whole_of(
                move_triangle(q.c.a_in_b, row.centre, row.shift, q.a.leaves[leaf], lane, nullptr));
            near = near && !apart_from_tight(whole, box.c, box.h, row.origin, q.c.tight_slack);
        }
        const std::uint32_t bits = ballot(near), leaf_bits = leaf != kNoLeaf ? bits & leaves_b : 0;
        at.node_pairs += static_cast<std::uint32_t>(__popc(bits));
        push(room, at, bits & ~leaf_bits, node_a.first_child + room.child[n], child_b);
        if (lane == 0) {
            room.leaf_bits[n] = leaf_bits;
        }
    }
    __syncwarp();  // all rows are read: the pairs of leaves overwrite them
    for (std::uint32_t n = 0; n < rows; ++n) {
        for (std::uint32_t left = room.leaf_bits[n]; left != 0 && !at.has_ended();
             left &= left - 1) {
            test_leaves(b, room, at, node_a.first_child + room.child[n],
                        node_b.first_child + lowest(left));
        }
    }
}

/// The whole descent.
__device__ Progress descend(const OfflineBuffers& b, Room& room) {
    const PreparedQuery& q = room.prepared.q;
    Progress at;
    at.node_pairs = 1;
    push(room, at, 1, 0, 0);
    while (at.open != 0 && !at.has_ended()) {
        __syncwarp();
        const OpenPair pair = room.open[--at.open];
        __syncwarp();  // before a lane overwrites it
        const TreeNode &node_a = q.a.nodes[pair.a], &node_b = q.b.nodes[pair.b];
        const bool leaf_a = is_leaf(node_a), leaf_b = is_leaf(node_b);
        if (leaf_a && leaf_b) {  // two roots
            test_leaves(b, room, at, pair.a, pair.b);
        } else if (leaf_a || leaf_b) {
            open_one(b, room, at, pair, node_a, node_b);
        } else {
            open_both(b, room, at, node_a, node_b);
        }
        at.is_again = at.is_again || at.node_pairs > b.node_pairs;
    }
    return at;
}

/// One slice of the trees, by a whole block.
__device__ void sum_slice(const OfflineBuffers& b, std::uint32_t slice) {
    const uint4* const words = reinterpret_cast<const uint4*>(b.tree_words) +
                               static_cast<std::size_t>(slice) * kOfflineSliceWords;
    unsigned long long sum = 0;
#pragma unroll
    for (unsigned i = 0; i < kOfflineSumLoads; ++i) {
        const std::uint32_t place = i * kOfflineThreads + threadIdx.x;
        const uint4 w = words[place];
        sum += sum_share(place, {w.x, w.y, w.z, w.w});
    }
    for (unsigned step = kWarp / 2; step != 0; step /= 2) {
        sum += __shfl_xor_sync(kAllLanes, sum, step);
    }
    __shared__ unsigned long long of_warps[kOfflineThreads / kWarp];
    if (lane_of_thread() == 0) {
        of_warps[threadIdx.x / kWarp] = sum;
    }
    __syncthreads();
    if (threadIdx.x == 0) {
        sum = 0;
        for (const unsigned long long of_warp : of_warps) {
            sum += of_warp;
        }
        b.sums[slice] = {b.sequence, slice, sum};
    }
}

__global__ void __launch_bounds__(kOfflineThreads, kBlocksPerMultiprocessor)
    answer_offline_kernel(const __grid_constant__ OfflineBuffers b) {
    if (blockIdx.x < b.slices) {
        sum_slice(b, blockIdx.x);
        return;
    }
    __shared__ Room rooms[kQueriesOfBlock];
    const std::uint32_t warp = threadIdx.x / kWarp;
    const std::uint32_t i = (blockIdx.x - b.slices) * kQueriesOfBlock + warp;
    if (i >= b.count) {
        return;
    }
    Room& room = rooms[warp];
    constexpr unsigned kWords = sizeof(OfflinePrepared) / sizeof(uint4);
    for (unsigned k = lane_of_thread(); k < kWords; k += kWarp) {
        reinterpret_cast<uint4*>(&room.prepared)[k] =
            reinterpret_cast<const uint4*>(&b.prepared[i])[k];
    }
    __syncwarp();
    const bool is_usable = room.prepared.is_usable != 0 && room.prepared.sequence == b.sequence;
    const Progress at = is_usable ? descend(b, room) : Progress{};
    if (lane_of_thread() == 0) {
        OfflineAnswer answer{};
        answer.sequence = room.prepared.sequence;
        answer.state = !is_usable    ? kOfflineRefused
                       : at.is_again ? kOfflineAgain
                       : at.is_near  ? kOfflineNear
                                     : kOfflineFar;
        answer.node_pairs = at.node_pairs;
        answer.triangle_pairs = at.triangle_pairs;
        answer.rechecks = at.rechecks;
        answer.check = check_of(answer, i);
        b.answers[i] = answer;
    }
}

}  // namespace

cudaError_t launch_answer_offline(const OfflineBuffers& buffers, cudaStream_t stream) noexcept {
    if (buffers.count == 0) {
        return cudaErrorInvalidValue;
    }
    const unsigned blocks =
        buffers.slices + (buffers.count + kQueriesOfBlock - 1) / kQueriesOfBlock;
    answer_offline_kernel<<<blocks, kOfflineThreads, 0, stream>>>(buffers);
    return cudaGetLastError();
}

}  // namespace axg::cuda
