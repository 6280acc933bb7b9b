// SPDX-License-Identifier: Apache-2.0
// Opens the pairs of nodes of one tree level, a block a pair: children of each against the other's
// own box, then every child left against every child left, a warp a child of a, a lane a child of
// b. The same rules as core/collision/traverse.inl, so the same pairs are found.
#include "cuda/engine/device_traversal.cuh"
#include "cuda/engine/kernels.hpp"
#include "cuda/engine/launch_kernel.cuh"

namespace axg::cuda {
namespace {

constexpr unsigned kWarps = 4, kThreads = kWarps * kWarp, kBlocksPerMultiprocessor = 6;

struct Shared {
    std::uint32_t bits_a, bits_b;
    std::uint32_t rows[2];  // of the batch, as far as this block knows; in turns
    float low_a[kNodeWidth], low_b[kNodeWidth];
};

/// One opened pair of nodes.
struct Opened {
    PairEntry at;
    std::uint32_t tree_level;
    const TreeNode& a;
    const TreeNode& b;
};

/// Charges a warp's pairs to their group: `all` lanes', of which this one's are `leaves` or not.
/// Returns those that its share holds: all pairs of leaves or none, and likewise of the others.
__device__ std::uint32_t charge_pairs(const DeviceBuffers& buffers, const PreparedQuery& q,
                                      const Opened& o, bool leaves, std::uint32_t all,
                                      std::uint32_t child_a, std::uint32_t child_b) {
    GroupSums& group = buffers.groups[q.group];
    const std::uint32_t leaf_bits = ballot(leaves), other_bits = all & ~leaf_bits;
    const std::uint32_t charged =
        leaf_bits == 0
            ? 0
            : warp_sum(leaves ? charged_leaves(q.a.nodes[child_a], q.b.nodes[child_b]) : 0);
    // A lane each, so that neither waits for the other.
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

/// Puts the wanted lanes' pairs where they belong: two leaves to the leaves, others one level on.
/// Called by whole warps.
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

/// Whether child `lane` of b is near child i of a: boxes along both bodies' axes, and where the
/// child of a is a leaf also the tight box of its moved triangles.
__device__ bool is_near_child(const PreparedQuery& q, const TreeNode& child_a, const Moved& moved,
                              const ChildBox& box, bool wanted) {
    bool near = wanted && is_near<false>(q.c.a_in_b, moved, box);
    if (ballot(near) != 0 && is_leaf(child_a)) {
        const Moved own = moved_box(q.c.a_in_b, child_a.box.c, child_a.box.h);
        const float* const centre = child_a.box.c;
        const MovedCentres to = move_centres<false>(q, centre, nullptr, own.c);
        const TightBox whole = whole_of(move_triangle(
            q.c.a_in_b, centre, to.a, q.a.leaves[child_a.leaf], lane_of_thread(), nullptr));
        near = near && !apart_from_tight(whole, box.c, box.h, own.c, q.c.tight_slack);
    }
    return near;
}

/// Adds to the batch's rows of boxes; the first thread gets what they come to.
__device__ std::uint32_t count_rows(const DeviceBuffers& buffers, std::uint32_t more) {
    return threadIdx.x == 0 && more != 0 ? atomicAdd(&buffers.counters->box_rows, more) + more : 0;
}

/// Charges the rows of an opened pair to its group: the children of a in `bits`. Called by whole
/// warps.
__device__ void charge_rows(const DeviceBuffers& buffers, const PreparedQuery& q, const Opened& o,
                            std::uint32_t bits) {
    const unsigned lane = lane_of_thread();
    const std::uint32_t charged =
        warp_sum((bits >> lane & 1U) != 0 ? charged_rows(q.a.nodes[o.a.first_child + lane]) : 0);
    if (lane == 0 && bits != 0) {
        charge(buffers.groups[q.group], kBoxRowsPlace, charged, loss_of_rows(o.tree_level));
    }
}

/// Returns the batch's rows of boxes so far, to the first thread.
__device__ std::uint32_t open_both(const DeviceBuffers& buffers, const PreparedQuery& q,
                                   const Opened& o, Shared& shared) {
    const unsigned lane = lane_of_thread(), warp = threadIdx.x / kWarp;
    if (warp < 2) {  // warp 0: children of b against a's box; warp 1: the other way round
        const TreeNode& node = warp == 0 ? o.b : o.a;
        const Aabb& box = warp == 0 ? o.a.box : o.b.box;
        const Frame& frame = warp == 0 ? q.c.a_in_b : q.c.b_in_a;
        const bool near = lane < node.count && is_near<true>(frame, moved_box(frame, box.c, box.h),
                                                             child_box(node, lane));
        const std::uint32_t bits = ballot(near);
        if (lane == 0) {
            (warp == 0 ? shared.bits_b : shared.bits_a) = bits;
        }
    }
    __syncthreads();
    const std::uint32_t bits_b = shared.bits_b;
    const ChildBox box = child_box(o.b, lane);
    std::uint32_t bits_a = bits_b == 0 ? 0 : shared.bits_a;
    const std::uint32_t rows = count_rows(buffers, static_cast<std::uint32_t>(__popc(bits_a)));
    for (unsigned n = 0; bits_a != 0; bits_a &= bits_a - 1, ++n) {
        if (n % kWarps != warp) {
            continue;
        }
        const unsigned i = lowest(bits_a);
        const ChildBox own = child_box(o.a, i);
        const std::uint32_t child_a = o.a.first_child + i;
        const bool near = is_near_child(q, q.a.nodes[child_a], moved_box(q.c.a_in_b, own.c, own.h),
                                        box, (bits_b >> lane & 1U) != 0);
        append(buffers, q, o, near, child_a, o.b.first_child + lane, 0);
    }
    if (buffers.limits.is_stage && warp == 0) {
        charge_rows(buffers, q, o, bits_b == 0 ? 0 : shared.bits_a);
    }
    return rows;
}

/// Opens b alone (a is a leaf) or a alone (b is a leaf). The first warp does it.
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
    // Other blocks lose groups meanwhile: all threads of this one have to see the same.
    if (buffers.limits.is_stage &&
        __syncthreads_or(is_lost(buffers, q, loss_of_rows(tree_level)) ? 1 : 0) != 0) {
        return 0;
    }
    if (is_over(tally, tree_level, buffers.limits.node_pairs) ||
        (measures && !(at.low_mm < bound))) {
        return 0;
    }
    if (leaf_a && leaf_b) {  // two roots: pairs found further down go to the leaves at once
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
    return measures ? open_nearest(buffers, q, o, bound, shared) : open_both(buffers, q, o, shared);
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
        const PairEntry at = b.tree_level[tree_level % 2][i];
        // Rows beyond the limit: the whole batch is not proven, whatever is left out here.
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
