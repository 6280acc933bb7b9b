// SPDX-License-Identifier: Apache-2.0
// Opens the pairs of nodes of one tree level, one block per pair. Tests the children of each node
// against the other's own box, then the remaining children against each other: a warp per child of
// a (a row), a lane per child of b. Charges, counts and lists the pairs of all rows at once: a
// chain of atomics costs more than a row. Same rules and pairs as core/collision/traverse.inl.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 8;

/// Data of a child of a that all lanes of its row read.
struct alignas(16) Row {
    Moved moved;               // its box in a, moved
    std::uint32_t leaf, more;  // of its node
    // Only for a leaf: its centre, the moved centre, and the exact moved centre less that.
    float centre[3], origin[3], shift[3];
};

/// Shared input of the rows of an opened pair, and the pairs that they found.
struct Rows {
    Row of[kNodeWidth];                  // by child of a
    std::uint8_t child[kNodeWidth];      // of a, by row
    std::uint32_t leaves_b;              // children of b that are leaves
    std::uint32_t more_b[kNodeWidth];    // of their nodes
    std::uint32_t near[kNodeWidth];      // children of b, by row; at the end those to be stored
    std::uint32_t before[kNodeWidth];    // pairs of the rows before: of leaves, and << 16 others
    std::uint32_t charged[kWarps];       // by warp: pairs of leaves
    std::uint32_t leaves_at, others_at;  // places of the first pairs
};

struct Shared {
    std::uint32_t bits_a, bits_b;
    std::uint32_t rows[2];  // the batch's rows last read by this block; used alternately
    PairEntry next[kWarp];  // this block's next pairs, read together
    float low_a[kNodeWidth], low_b[kNodeWidth];
    Rows both;
};

/// charged_rows and charged_leaves, computed from the stored `more` of the nodes.
AXG_HD constexpr std::uint32_t charge_of_row(std::uint32_t more) {
    return 1 + more;
}
AXG_HD constexpr std::uint32_t charge_of_leaves(std::uint32_t more_a, std::uint32_t more_b) {
    return 1 + more_a + more_b;
}
constexpr TreeNode node_with(std::uint32_t more) {
    TreeNode node{};
    node.more = more;
    return node;
}
static_assert(charge_of_row(7) == charged_rows(node_with(7)));
static_assert(charge_of_leaves(7, 50) == charged_leaves(node_with(7), node_with(50)));

/// One opened pair of nodes.
struct Opened {
    const PairEntry& at;
    std::uint32_t tree_level;
    const TreeNode& a;
    const TreeNode& b;
};

/// Charges the pairs of the lanes in `all` to their group; `leaves`: this lane has two leaves.
/// Returns the lanes that its share covers: all pairs of leaves or none, all other pairs or none.
__device__ std::uint32_t charge_pairs(const DeviceBuffers& buffers, const PreparedQuery& q,
                                      const Opened& o, bool leaves, std::uint32_t all,
                                      std::uint32_t child_a, std::uint32_t child_b) {
    GroupSums& group = buffers.groups[q.group];
    const std::uint32_t leaf_bits = ballot(leaves), other_bits = all & ~leaf_bits;
    const std::uint32_t charged =
        leaf_bits == 0
            ? 0
            : warp_sum(leaves ? charged_leaves(q.a.nodes[child_a], q.b.nodes[child_b]) : 0);
    // One lane per list, so that neither waits for the other.
    bool fits = true;
    if (lane_of_thread() == 0 && leaf_bits != 0) {
        fits = charge(group, kLeafPairsPlace, charged, loss_of_leaves(o.tree_level));
    } else if (lane_of_thread() == 1 && other_bits != 0) {
        fits = charge(group, kNodePairsPlace, static_cast<std::uint32_t>(__popc(other_bits)),
                      loss_of_nodes(o.tree_level));
    }
    const std::uint32_t fitting = ballot(fits);
    return ((fitting & 1U) != 0 ? leaf_bits : 0) | ((fitting & 2U) != 0 ? other_bits : 0);
}

/// Lists this lane's pair if required: two leaves in the leaves, others in the next level. Called
/// by whole warps.
__device__ void append(const DeviceBuffers& buffers, const PreparedQuery& q, const Opened& o,
                       bool wanted, std::uint32_t child_a, std::uint32_t child_b, float low_mm) {
    const std::uint32_t all = ballot(wanted);
    if (all == 0) {
        return;
    }
    const bool leaves = wanted && is_leaf(q.a.nodes[child_a]) && is_leaf(q.b.nodes[child_b]);
    const std::uint32_t found = ballot(leaves);
    const std::uint32_t fitting =
        buffers.limits.is_stage ? charge_pairs(buffers, q, o, leaves, all, child_a, child_b) : all;
    const std::uint32_t leaf_bits = found & fitting, other_bits = all & ~found & fitting;
    std::uint32_t leaf_at = 0, other_at = 0;
    if (lane_of_thread() == 0) {
        atomicAdd(&buffers.tallies[o.at.query].pairs_at[o.tree_level + 1],
                  static_cast<std::uint32_t>(__popc(all)));
        if (leaf_bits != 0) {
            leaf_at = atomicAdd(&buffers.counters->leaf_listed,
                                static_cast<std::uint32_t>(__popc(leaf_bits)));
        }
        if (other_bits != 0) {
            other_at = atomicAdd(&buffers.counters->listed[o.tree_level + 1],
                                 static_cast<std::uint32_t>(__popc(other_bits)));
        }
    }
    leaf_at = __shfl_sync(kAllLanes, leaf_at, 0) + rank_in(leaf_bits);
    other_at = __shfl_sync(kAllLanes, other_at, 0) + rank_in(other_bits);
    const PairEntry entry{o.at.query, child_a, child_b, low_mm};
    const BatchBudget& budget = buffers.counters->budget;
    const bool fits = (fitting >> lane_of_thread() & 1U) != 0;
    if (leaves && fits && leaf_at < budget.leaf_pairs) {
        buffers.leaves[leaf_at] = entry;
    }
    if (wanted && !leaves && fits && other_at < budget.level_pairs) {
        buffers.tree_level[(o.tree_level + 1) % 2][other_at] = entry;
    }
}

/// Whether child `lane` of b is near the row's child of a. Compares boxes along both bodies' axes
/// and, if the child of a is a leaf, the tight box of its moved triangles.
__device__ bool is_near_child(const PreparedQuery& q, const Row& row, const ChildBox& box,
                              bool wanted) {
    bool near = wanted && is_near<false>(q.c.a_in_b, row.moved, box);
    if (ballot(near) != 0 && row.leaf != kNoLeaf) {
        const TightBox whole = whole_of(move_triangle(
            q.c.a_in_b, row.centre, row.shift, q.a.leaves[row.leaf], lane_of_thread(), nullptr));
        near = near && !apart_from_tight(whole, box.c, box.h, row.origin, q.c.tight_slack);
    }
    return near;
}

/// Adds to the batch's rows of boxes. Returns the sum to the first thread, 0 to the others.
__device__ std::uint32_t count_rows(const DeviceBuffers& buffers, std::uint32_t more) {
    return threadIdx.x == 0 && more != 0 ? atomicAdd(&buffers.counters->box_rows, more) + more : 0;
}

/// Stores the data of the children of each body that the rows need, one lane per child.
__device__ void read_children_of_b(const PreparedQuery& q, const Opened& o, Rows& rows) {
    const unsigned lane = lane_of_thread();
    const bool is_child = lane < o.b.count;
    const TreeNode* const child = q.b.nodes + o.b.first_child + (is_child ? lane : 0);
    const std::uint32_t leaf = child->leaf, more = child->more;
    const ChildBox own = child_box(o.a, lane);
    rows.of[lane].moved = moved_box(q.c.a_in_b, own.c, own.h);
    rows.more_b[lane] = more;
    const std::uint32_t leaves = ballot(is_child && leaf != kNoLeaf);
    if (lane == 0) {
        rows.leaves_b = leaves;
    }
}
__device__ void read_children_of_a(const PreparedQuery& q, const Opened& o, Rows& rows) {
    const unsigned lane = lane_of_thread();
    if (lane >= o.a.count) {
        return;
    }
    const TreeNode& child = q.a.nodes[o.a.first_child + lane];
    Row& row = rows.of[lane];
    row.leaf = child.leaf;
    row.more = child.more;
    if (is_leaf(child)) {
        const Moved own = moved_box(q.c.a_in_b, child.box.c, child.box.h);
        for (int k = 0; k < 3; ++k) {
            row.centre[k] = child.box.c[k];
            row.origin[k] = own.c[k];
            row.shift[k] = moved_centre(q.pose, k, child.box.c, own.c[k]);
        }
    }
}

/// Tests the children of each node against the other's own box: warp 0 those of b, warp 1 those of
/// a. Two more warps store the data of the children that the rows need.
__device__ void look_at_children(const PreparedQuery& q, const Opened& o, Shared& shared) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    Rows& rows = shared.both;
    if (warp < 2) {
        const TreeNode& node = warp == 0 ? o.b : o.a;
        const Aabb& box = warp == 0 ? o.a.box : o.b.box;
        const Frame& frame = warp == 0 ? q.c.a_in_b : q.c.b_in_a;
        const bool near = lane < node.count && is_near<true>(frame, moved_box(frame, box.c, box.h),
                                                             child_box(node, lane));
        const std::uint32_t bits = ballot(near);
        if (lane == 0) {
            (warp == 0 ? shared.bits_b : shared.bits_a) = bits;
        }
        if (warp == 1 && near) {
            rows.child[rank_in(bits)] = static_cast<std::uint8_t>(lane);
        }
    }
    if (warp == kWarps - 2) {
        read_children_of_b(q, o, rows);
    } else if (warp == kWarps - 1) {
        read_children_of_a(q, o, rows);
    }
}

/// Tests this warp's rows. Returns whether any of them found a pair.
__device__ bool test_rows(const DeviceBuffers& buffers, const PreparedQuery& q, const Opened& o,
                          unsigned row_count, std::uint32_t bits_b, Rows& rows) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    const ChildBox box = child_box(o.b, lane);
    const bool wanted = (bits_b >> lane & 1U) != 0, leaf_b = (rows.leaves_b >> lane & 1U) != 0;
    const std::uint32_t more_b = rows.more_b[lane];
    std::uint32_t found = 0, charged = 0;
    for (unsigned n = warp; n < row_count; n += kWarps) {
        const Row& row = rows.of[rows.child[n]];
        const bool near = is_near_child(q, row, box, wanted);
        const std::uint32_t bits = ballot(near);
        charged += near && leaf_b && row.leaf != kNoLeaf ? charge_of_leaves(row.more, more_b) : 0;
        found |= bits;
        if (lane == 0) {
            rows.near[n] = bits;
        }
    }
    if (buffers.limits.is_stage) {
        charged = warp_sum(charged);
        if (lane == 0) {
            rows.charged[warp] = charged;
        }
    }
    return found != 0;
}

/// Pairs of leaves among the pairs that row n found.
__device__ __forceinline__ std::uint32_t leaves_in(const Rows& rows, unsigned n,
                                                   std::uint32_t bits) {
    return rows.of[rows.child[n]].leaf != kNoLeaf ? bits & rows.leaves_b : 0;
}

/// Charges and counts all rows, and reserves places for the pairs that they found: in a group all
/// pairs of leaves or none, and all other pairs or none. Called by the first warp, one lane per
/// row. Returns the batch's rows of boxes so far to the first thread.
__device__ std::uint32_t list_rows(const DeviceBuffers& buffers, const PreparedQuery& q,
                                   const Opened& o, unsigned row_count, Rows& rows) {
    const unsigned lane = lane_of_thread();
    const bool is_row = lane < row_count;
    const std::uint32_t bits = is_row ? rows.near[lane] : 0;
    const std::uint32_t leaf_bits = is_row ? leaves_in(rows, lane, bits) : 0;
    const std::uint32_t other_bits = bits & ~leaf_bits;
    // Both sums in one word: neither exceeds kLeafPairs.
    static_assert(kLeafPairs < 1U << 16U);
    const auto own = static_cast<std::uint32_t>(__popc(leaf_bits)) |
                     static_cast<std::uint32_t>(__popc(other_bits)) << 16U;
    const std::uint32_t of_rows =
        warp_sum(is_row ? charge_of_row(rows.of[rows.child[lane]].more) : 0);
    std::uint32_t sum = own;
    for (unsigned step = 1; step < kWarp; step *= 2) {
        const std::uint32_t below = __shfl_up_sync(kAllLanes, sum, step);
        sum += lane >= step ? below : 0;
    }
    const std::uint32_t all = __shfl_sync(kAllLanes, sum, kWarp - 1);
    const std::uint32_t leaves = all & 0xffffU, others = all >> 16U;
    // One lane per atomic, so that none waits for another.
    Counters& counters = *buffers.counters;
    std::uint32_t rows_before = 0;
    bool fits = true;
    if (lane == 0) {
        rows_before = atomicAdd(&counters.box_rows, row_count);
    } else if (lane == 1 && all != 0) {
        atomicAdd(&buffers.tallies[o.at.query].pairs_at[o.tree_level + 1], leaves + others);
    }
    constexpr unsigned kLeavesLane = 2, kOthersLane = 3, kRowsLane = 4;
    if (buffers.limits.is_stage) {
        std::uint32_t of_leaves = 0;
        for (const std::uint32_t charged : rows.charged) {
            of_leaves += charged;
        }
        const std::uint32_t more = lane == kLeavesLane   ? of_leaves
                                   : lane == kOthersLane ? others
                                   : lane == kRowsLane   ? of_rows
                                                         : 0;
        const WorkListPlace list = lane == kLeavesLane   ? kLeafPairsPlace
                                   : lane == kOthersLane ? kNodePairsPlace
                                                         : kBoxRowsPlace;
        if (more != 0) {
            fits = charge(buffers.groups[q.group], list, more,
                          lane == kLeavesLane   ? loss_of_leaves(o.tree_level)
                          : lane == kOthersLane ? loss_of_nodes(o.tree_level)
                                                : loss_of_rows(o.tree_level));
        }
    }
    const std::uint32_t fitting = ballot(fits);
    const bool leaves_fit = (fitting >> kLeavesLane & 1U) != 0,
               others_fit = (fitting >> kOthersLane & 1U) != 0;
    const std::uint32_t places = lane == 0   ? (leaves_fit ? leaves : 0)
                                 : lane == 1 ? (others_fit ? others : 0)
                                             : 0;
    if (places != 0) {
        std::uint32_t& listed =
            lane == 0 ? counters.leaf_listed : counters.listed[o.tree_level + 1];
        (lane == 0 ? rows.leaves_at : rows.others_at) = atomicAdd(&listed, places);
    }
    if (is_row) {
        rows.near[lane] = (leaves_fit ? leaf_bits : 0) | (others_fit ? other_bits : 0);
        rows.before[lane] = sum - own;
    }
    return rows_before + row_count;
}

/// Stores the pairs of this warp's rows for which list_rows reserved places.
__device__ void store_rows(const DeviceBuffers& buffers, const Opened& o, unsigned row_count,
                           std::uint32_t leaf_budget, std::uint32_t level_budget,
                           const Rows& rows) {
    const unsigned lane = lane_of_thread();
    for (unsigned n = threadIdx.x / kWarp; n < row_count; n += kWarps) {
        const std::uint32_t bits = rows.near[n], leaf_bits = leaves_in(rows, n, bits);
        if (bits == 0) {
            continue;
        }
        const bool leaves = (leaf_bits >> lane & 1U) != 0;
        const std::uint32_t place =
            leaves ? rows.leaves_at + (rows.before[n] & 0xffffU) + rank_in(leaf_bits)
                   : rows.others_at + (rows.before[n] >> 16U) + rank_in(bits & ~leaf_bits);
        if ((bits >> lane & 1U) != 0 && place < (leaves ? leaf_budget : level_budget)) {
            PairEntry* const list =
                leaves ? buffers.leaves : buffers.tree_level[(o.tree_level + 1) % 2];
            list[place] = {o.at.query, o.a.first_child + rows.child[n], o.b.first_child + lane, 0};
        }
    }
}

/// Opens two inner nodes. Returns the batch's rows of boxes so far to the first thread.
/// @param lost  whether this thread saw the group lost; other threads may have read another value
__device__ std::uint32_t open_both(const DeviceBuffers& buffers, const PreparedQuery& q,
                                   const Opened& o, bool lost, Shared& shared) {
    look_at_children(q, o, shared);
    if (__syncthreads_or(lost ? 1 : 0) != 0) {
        return 0;
    }
    const std::uint32_t bits_b = shared.bits_b;
    const auto row_count = bits_b == 0 ? 0U : static_cast<std::uint32_t>(__popc(shared.bits_a));
    if (row_count == 0) {
        return 0;
    }
    const bool finds = test_rows(buffers, q, o, row_count, bits_b, shared.both);
    const bool any = __syncthreads_or(finds ? 1 : 0) != 0;
    const std::uint32_t leaf_budget = buffers.counters->budget.leaf_pairs,
                        level_budget = buffers.counters->budget.level_pairs;
    std::uint32_t so_far = 0;
    if (threadIdx.x < kWarp) {
        so_far = list_rows(buffers, q, o, row_count, shared.both);
    }
    if (any) {
        __syncthreads();
        store_rows(buffers, o, row_count, leaf_budget, level_budget, shared.both);
    }
    return so_far;
}

/// Opens only b (a is a leaf) or only a (b is a leaf). Only the first warp works.
__device__ std::uint32_t open_one(const DeviceBuffers& buffers, const PreparedQuery& q,
                                  const Opened& o, bool measures, double bound) {
    if (threadIdx.x >= kWarp) {
        return 0;
    }
    const std::uint32_t rows = count_rows(buffers, 1);
    const bool opens_b = is_leaf(o.a);
    const TreeNode& node = opens_b ? o.b : o.a;
    const Aabb& kept = opens_b ? o.a.box : o.b.box;
    const Frame& frame = opens_b ? q.c.a_in_b : q.c.b_in_a;
    const unsigned lane = lane_of_thread();
    const Moved moved = moved_box(frame, kept.c, kept.h);
    const ChildBox box = child_box(node, lane);
    bool wanted = lane < node.count;
    float low = 0;
    if (measures) {
        low = lanes::max(low_bound(frame, moved, box), o.at.low_mm);
        wanted = wanted && low < bound;
    } else {
        wanted = wanted && is_near<true>(frame, moved, box);
    }
    append(buffers, q, o, wanted, opens_b ? o.at.a : o.a.first_child + lane,
           opens_b ? o.b.first_child + lane : o.at.b, low);
    return rows;
}

/// Clearance: every pair of children that may be nearer than `bound`.
__device__ std::uint32_t open_nearest(const DeviceBuffers& buffers, const PreparedQuery& q,
                                      const Opened& o, double bound, Shared& shared) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    if (warp < 2) {
        const TreeNode& node = warp == 0 ? o.b : o.a;
        const Aabb& box = warp == 0 ? o.a.box : o.b.box;
        const Frame& frame = warp == 0 ? q.c.a_in_b : q.c.b_in_a;
        const float low = low_bound(frame, moved_box(frame, box.c, box.h), child_box(node, lane));
        (warp == 0 ? shared.low_b : shared.low_a)[lane] = low;
        const std::uint32_t bits = ballot(lane < node.count && low < bound);
        if (lane == 0) {
            (warp == 0 ? shared.bits_b : shared.bits_a) = bits;
        }
    }
    __syncthreads();
    const ChildBox box = child_box(o.b, lane);
    const float low_b = shared.low_b[lane];
    std::uint32_t bits_a = shared.bits_b == 0 ? 0 : shared.bits_a;
    const std::uint32_t rows = count_rows(buffers, static_cast<std::uint32_t>(__popc(bits_a)));
    for (unsigned n = 0; bits_a != 0; bits_a &= bits_a - 1, ++n) {
        if (n % kWarps != warp) {
            continue;
        }
        const unsigned i = lowest(bits_a);
        const ChildBox own = child_box(o.a, i);
        const float pair = low_bound(q.c.a_in_b, moved_box(q.c.a_in_b, own.c, own.h), box);
        const float low =
            lanes::max(lanes::max(pair, o.at.low_mm), lanes::max(shared.low_a[i], low_b));
        append(buffers, q, o, lane < o.b.count && low < bound, o.a.first_child + i,
               o.b.first_child + lane, low);
    }
    return rows;
}

__device__ std::uint32_t open(const DeviceBuffers& buffers, const PairEntry& at,
                              std::uint32_t tree_level, Shared& shared) {
    const PreparedQuery& q = buffers.prepared[at.query];
    const Tally& tally = buffers.tallies[at.query];
    const Opened o{at, tree_level, q.a.nodes[at.a], q.b.nodes[at.b]};
    const bool leaf_a = is_leaf(o.a), leaf_b = is_leaf(o.b),
               measures = q.kind == QueryKind::clearance;
    const double bound = tally.bound_mm;
    const bool lost = is_lost(buffers, q, loss_of_rows(tree_level));
    if (is_over(tally, tree_level, buffers.limits.node_pairs) ||
        (measures && !(at.low_mm < bound))) {
        return 0;
    }
    if (!leaf_a && !leaf_b && !measures) {
        return open_both(buffers, q, o, lost, shared);
    }
    // Other blocks may lose the group meanwhile: all threads of this block have to agree.
    if (buffers.limits.is_stage && __syncthreads_or(lost ? 1 : 0) != 0) {
        return 0;
    }
    if (leaf_a && leaf_b) {  // two roots: deeper pairs of leaves are listed when they are found
        if (threadIdx.x == 0 && (!buffers.limits.is_stage ||
                                 charge(buffers.groups[q.group], kLeafPairsPlace,
                                        charged_leaves(o.a, o.b), loss_of_leaves(tree_level)))) {
            const std::uint32_t place = atomicAdd(&buffers.counters->leaf_listed, 1U);
            if (place < buffers.counters->budget.leaf_pairs) {
                buffers.leaves[place] = at;
            }
        }
        return 0;
    }
    if (leaf_a || leaf_b) {
        return open_one(buffers, q, o, measures, bound);
    }
    return open_nearest(buffers, q, o, bound, shared);
}

/// Reads the next pairs of this block, from the i-th of the level on: one lane per pair, so that
/// the block waits once for 32 pairs. Called by whole blocks, when no thread reads the last pairs.
__device__ void read_pairs(const DeviceBuffers& b, std::uint32_t i, std::uint32_t count,
                           std::uint32_t tree_level, Shared& shared) {
    const std::uint32_t own = i + threadIdx.x * gridDim.x;
    if (threadIdx.x < kWarp && own < count) {
        shared.next[threadIdx.x] = b.tree_level[tree_level % 2][own];
    }
    __syncthreads();
}

__global__ void __launch_bounds__(kThreads, kBlocksPerMultiprocessor)
    open_pairs_kernel(const __grid_constant__ DeviceBuffers b, std::uint32_t tree_level) {
    wait_for_kernel_before();
    __shared__ Shared shared;
    const BatchBudget& budget = b.counters->budget;
    const std::uint32_t count =
        min(b.counters->listed[tree_level], tree_level_budget(b, tree_level));
    std::uint32_t handled = 0, rows = 0;
    for (std::uint32_t i = blockIdx.x; i < count; i += gridDim.x, ++handled) {
        if (handled % kWarp == 0) {
            read_pairs(b, i, count, tree_level, shared);
        }
        const PairEntry& at = shared.next[handled % kWarp];
        // Rows beyond the limit: the whole batch is not proven, so this may skip pairs.
        if (at.query != kNoQuery && rows <= budget.box_rows) {
            rows = max(rows, open(b, at, tree_level, shared));
        }
        if (threadIdx.x == 0) {
            shared.rows[handled % 2] = rows;
        }
        __syncthreads();
        rows = shared.rows[handled % 2];
    }
    if (threadIdx.x == 0 && handled != 0) {
        atomicAdd(&b.counters->handled[tree_level], handled);
    }
}

}  // namespace

cudaError_t launch_open_pairs(const DeviceBuffers& buffers, const Launch& launch,
                              std::uint32_t tree_level) noexcept {
    const unsigned blocks = launch.multiprocessors * kBlocksPerMultiprocessor;
    return launch_kernel(open_pairs_kernel, blocks, kThreads, launch, buffers, tree_level);
}

}  // namespace axg::cuda
