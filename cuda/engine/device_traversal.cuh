// SPDX-License-Identifier: Apache-2.0
// The arithmetic of the traversal as device code: a thread is a lane of width one. Every kernel
// includes it. Every decision uses the same source lines as the CPU engine.
#pragma once

#include <cuda_runtime.h>

#include "core/base/finite.hpp"
#include "core/collision/certified_within.hpp"
#include "core/collision/double_test.hpp"
#include "core/collision/lanes_one.hpp"
#include "core/collision/pair_test.hpp"
#include "cuda/engine/device_data.hpp"

namespace axg::cuda {

using V = lanes::Float1;
inline constexpr unsigned kW = 1;
inline constexpr std::uint32_t kLaneBits = 1;
inline constexpr unsigned kLeafPairs = kNodeWidth * kNodeWidth;

#include "core/collision/box_test.inl"
#include "core/collision/traverse_query.inl"

/// A query as the kernels read it.
struct PreparedQuery {
    QueryConstants c;
    Pose pose, inverse;
    DeviceTree a, b;
    double r_mm;
    float near_mm;  // of certified_within; 0 without a margin
    QueryKind kind;
    bool is_float_only;
    bool wants_list;
    std::uint16_t group;  // of a stage
};

inline constexpr unsigned kWarp = 32;
inline constexpr unsigned kAllLanes = 0xffffffffU;
static_assert(kNodeWidth == kWarp, "a lane a child");

__device__ __forceinline__ unsigned lane_of_thread() {
    return threadIdx.x % kWarp;
}
__device__ __forceinline__ std::uint32_t ballot(bool is_set) {
    return __ballot_sync(kAllLanes, is_set);
}
__device__ __forceinline__ unsigned lowest(std::uint32_t bits) {
    return static_cast<unsigned>(__ffs(static_cast<int>(bits))) - 1;
}
/// Set lanes below this one.
__device__ __forceinline__ unsigned rank_in(std::uint32_t bits) {
    return static_cast<unsigned>(__popc(bits & ((1U << lane_of_thread()) - 1U)));
}
__device__ __forceinline__ bool is_leaf(const TreeNode& node) {
    return node.leaf != kNoLeaf;
}

/// Least of a warp's values. A zero may have either sign.
__device__ __forceinline__ float warp_least(float value) {
    for (unsigned step = kWarp / 2; step != 0; step /= 2) {
        value = fminf(value, __shfl_xor_sync(kAllLanes, value, step));
    }
    return value;
}

/// One triangle's box along the other body's axes, from moved vertices.
struct TightBox {
    float low[3], high[3];
};

/// The union of the boxes of a warp's triangles: `leaf_low` and `leaf_high` of the traversal. The
/// first steps divide the six numbers among the lanes: 14 exchanges instead of 30, of which a
/// multiprocessor executes one per clock. A zero may have either sign.
__device__ __forceinline__ TightBox whole_of(const TightBox& own) {
    const auto least_with = [](float kept, float given, unsigned step) {
        return fminf(kept, __shfl_xor_sync(kAllLanes, given, step));
    };
    const unsigned lane = lane_of_thread();
    const bool has_high = (lane & 16U) != 0, has_second = (lane & 8U) != 0,
               has_third = (lane & 4U) != 0;
    float axis[3];  // low, or high with the other sign
    for (int k = 0; k < 3; ++k) {
        const float low = own.low[k], high = -own.high[k];
        axis[k] = least_with(has_high ? high : low, has_high ? low : high, 16);
    }
    const float first =
        least_with(has_second ? axis[1] : axis[0], has_second ? axis[0] : axis[1], 8);
    const float third = least_with(axis[2], axis[2], 8);
    float least = least_with(has_third ? third : first, has_third ? first : third, 4);
    least = least_with(least, least, 2);
    least = least_with(least, least, 1);
    TightBox whole;
    for (int k = 0; k < 3; ++k) {
        const int lane_of_axis = k == 0 ? 0 : k == 1 ? 8 : 4;
        whole.low[k] = __shfl_sync(kAllLanes, least, lane_of_axis);
        whole.high[k] = -__shfl_sync(kAllLanes, least, 16 + lane_of_axis);
    }
    return whole;
}

/// Centres of leaves in the other body's frame: a's less the origin, and b's.
struct MovedCentres {
    float a[3], b[3];
};

/// v[k] without an array in local memory.
__device__ __forceinline__ float one_of(const float* v, unsigned k) {
    return k == 0 ? v[0] : k == 1 ? v[1] : v[2];
}

/// moved_centre of a leaf of a and, with kBoth, of a leaf of b: one coordinate per lane, because
/// small devices have few units for double. Called by whole warps.
template <bool kBoth>
__device__ __forceinline__ MovedCentres move_centres(const PreparedQuery& q, const float* centre_a,
                                                     const float* centre_b, const float* origin) {
    const unsigned lane = lane_of_thread(), k = lane % 3;
    const bool is_a = !kBoth || lane < 3;
    // Lanes widen a's centre, b's centre, the origin; three each.
    const double own = lane < 3              ? one_of(centre_a, k)
                       : (lane < 6 && kBoth) ? one_of(centre_b, k)
                                             : one_of(origin, k);
    double c[3];
    for (unsigned i = 0; i < 3; ++i) {
        c[i] = __shfl_sync(kAllLanes, own, static_cast<int>(is_a ? i : 3 + i));
    }
    const double from = __shfl_sync(kAllLanes, own, static_cast<int>(6 + k));
    const Pose& p = is_a ? q.pose : q.inverse;
    const auto moved = static_cast<float>(
        moved_coordinate(p, static_cast<int>(k), c[0], c[1], c[2], is_a ? from : 0.0));
    MovedCentres out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = __shfl_sync(kAllLanes, moved, i);
        out.b[i] = kBoth ? __shfl_sync(kAllLanes, moved, 3 + i) : 0.0F;
    }
    return out;
}

/// Moves this lane's triangle about its leaf's centre, which moves to `shift`. Stores the nine
/// coordinates in v unless it is null.
__device__ __forceinline__ TightBox move_triangle(const Frame& f, const float* centre,
                                                  const float* shift, const TreeLeaf& leaf,
                                                  unsigned lane, float* v) {
    TightBox box;
    for (int i = 0; i < 3; ++i) {
        const V x{leaf.v[3 * i][lane] - centre[0]}, y{leaf.v[3 * i + 1][lane] - centre[1]},
            z{leaf.v[3 * i + 2][lane] - centre[2]};
        for (int k = 0; k < 3; ++k) {
            const float c = moved_about(f, k, shift[k], x, y, z).v;
            if (v != nullptr) {
                v[3 * i + k] = c;
            }
            box.low[k] = i == 0 ? c : lanes::min(c, box.low[k]);
            box.high[k] = i == 0 ? c : lanes::max(c, box.high[k]);
        }
    }
    return box;
}

/// Whether a box (centre c, half widths h, along the same axes) is apart from a tight box.
__device__ __forceinline__ bool apart_from_tight(const TightBox& tight, const float* c,
                                                 const float* h, const float* origin, float slack) {
    bool apart = false;
    for (int k = 0; k < 3; ++k) {
        const float centre = c[k] - origin[k], half = h[k] + slack;
        apart = apart || tight.low[k] > centre + half || centre - half > tight.high[k];
    }
    return apart;
}

/// One child's box, loaded once by the lane that has it.
struct ChildBox {
    float c[3], h[3];
};

__device__ __forceinline__ ChildBox child_box(const TreeNode& node, unsigned lane) {
    return {{node.c[0][lane], node.c[1][lane], node.c[2][lane]},
            {node.h[0][lane], node.h[1][lane], node.h[2][lane]}};
}

/// Whether the moved box and a child's box are not proven apart.
template <bool kCrosses>
__device__ __forceinline__ bool is_near(const Frame& f, const Moved& m, const ChildBox& box) {
    const V c[3] = {{box.c[0]}, {box.c[1]}, {box.c[2]}};
    const V h[3] = {{box.h[0]}, {box.h[1]}, {box.h[2]}};
    return near_lanes<kCrosses>(f, every_lane(m), c, h) != 0;
}

/// A certified lower bound of the distance of a moved box and a child's box.
__device__ __forceinline__ float low_bound(const Frame& f, const Moved& m, const ChildBox& box) {
    const V c[3] = {{box.c[0]}, {box.c[1]}, {box.c[2]}};
    const V h[3] = {{box.h[0]}, {box.h[1]}, {box.h[2]}};
    return low_bounds(f, every_lane(m), c, h).v;
}

/// Vertices of two triangles, less a common origin.
struct Vertices {
    sat::V3<float> a[3], b[3];
};

/// Two triangles of moved leaves in shared memory.
__device__ __forceinline__ Vertices vertices_of(const float (*a)[kNodeWidth], unsigned i,
                                                const float (*b)[kNodeWidth], unsigned j) {
    Vertices v;
    for (int k = 0; k < 3; ++k) {
        v.a[k] = {a[3 * k][i], a[3 * k + 1][i], a[3 * k + 2][i]};
        v.b[k] = {b[3 * k][j], b[3 * k + 1][j], b[3 * k + 2][j]};
    }
    return v;
}

__device__ __forceinline__ sat::TrianglePair<float> float_pair(const float (*a)[kNodeWidth],
                                                               unsigned i,
                                                               const float (*b)[kNodeWidth],
                                                               unsigned j, float d32) {
    const Vertices v = vertices_of(a, i, b, j);
    return sat::scaled_pair(v.a, v.b, d32);
}

/// The most pairs of nodes on a level: the first level has a place for every query.
__device__ __forceinline__ std::uint32_t tree_level_budget(const DeviceBuffers& b,
                                                           std::uint32_t tree_level) {
    return tree_level == 0 ? b.limits.level_pairs : b.counters->budget.level_pairs;
}

/// Whether a query exceeded its pairs of nodes before `tree_level` was opened. The counts of the
/// levels up to this one are complete then, so the result does not depend on the order of work.
__device__ __forceinline__ bool is_over(const Tally& tally, std::uint32_t tree_level,
                                        std::uint32_t node_pairs) {
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i <= tree_level; ++i) {
        sum += tally.pairs_at[i];
    }
    return sum > node_pairs;
}

/// Charges `more` to a list of a group. Returns whether its share covers it.
__device__ __forceinline__ bool charge(GroupSums& group, WorkListPlace list, std::uint32_t more,
                                       std::uint32_t loss) {
    const bool fits = atomicAdd(&group.used[list], more) + more <= group.share[list];
    if (!fits) {
        atomicMin(&group.lost, loss);
    }
    return fits;
}

/// Whether a query's group was lost at `loss` or before; false in a batch without groups. While a
/// kernel runs, two threads may read different values: threads that branch on it have to vote.
__device__ __forceinline__ bool is_lost(const DeviceBuffers& b, const PreparedQuery& q,
                                        std::uint32_t loss) {
    return b.limits.is_stage &&
           *static_cast<const volatile std::uint32_t*>(&b.groups[q.group].lost) <= loss;
}

/// Sum over all lanes of a warp.
__device__ __forceinline__ std::uint32_t warp_sum(std::uint32_t value) {
    for (unsigned step = kWarp / 2; step != 0; step /= 2) {
        value += __shfl_xor_sync(kAllLanes, value, step);
    }
    return value;
}

/// Rechecks that a query needs: none if it is not proven whatever their results. All its pairs of
/// triangles are counted and tested by then, so the result does not depend on the order of work.
__device__ __forceinline__ std::uint32_t rechecks_wanted(const DeviceBuffers& b,
                                                         std::uint32_t query) {
    const Tally& tally = b.tallies[query];
    const bool is_none = tally.triangle_pairs > b.limits.triangle_pairs ||
                         tally.rechecks > b.limits.rechecks || tally.near != 0 ||
                         tally.refused != 0 || is_lost(b, b.prepared[query], kLossOfRechecks);
    return is_none ? 0 : tally.rechecks;
}

__device__ __forceinline__ void lower(unsigned long long& to, double value) {
    atomicMin(&to, __builtin_bit_cast(unsigned long long, value));  // not negative: bits sort
}

/// Both triangles of an entry, in double.
__device__ __forceinline__ sat::TrianglePair<double> double_pair_of(const PreparedQuery& q,
                                                                    const TriangleEntry& e) {
    const TreeNode& a = q.a.nodes[e.node_a];
    const TreeNode& b = q.b.nodes[e.node_b];
    const Moved box = moved_box(q.c.a_in_b, a.box.c, a.box.h);  // its centre is the origin
    return double_pair(q.c, q.pose, box.c, q.a.leaves[a.leaf], e.place_a, q.b.leaves[b.leaf],
                       e.place_b);
}

__device__ __forceinline__ TriangleIds ids_of(const PreparedQuery& q, const TriangleEntry& e) {
    return {q.a.leaves[q.a.nodes[e.node_a].leaf].triangle[e.place_a],
            q.b.leaves[q.b.nodes[e.node_b].leaf].triangle[e.place_b]};
}

}  // namespace axg::cuda
