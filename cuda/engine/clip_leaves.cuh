// SPDX-License-Identifier: Apache-2.0
// A pair of leaves in one warp: moves both and gathers the pairs of triangles whose tight boxes are
// not apart. Bits as core/collision/move_leaves.inl and near_triangles of traverse.inl.
#pragma once

#include "cuda/engine/device_traversal.cuh"

namespace axg::cuda {

/// Two moved leaves in shared memory, and the pairs of their triangles.
struct MovedPair {
    float a[9][kNodeWidth], b[9][kNodeWidth];  // less the common origin
    float d;                                   // of scale_of
    std::uint16_t pairs[kLeafPairs];           // place in a, place in b: five bits each
};

/// Two leaves of one query; `origin` is subtracted from both.
struct Leaves {
    const TreeNode& a;
    const TreeNode& b;
    const TreeLeaf& leaf_a;
    const TreeLeaf& leaf_b;
    float origin[3];
};

/// One lane's triangle of each leaf: the box of its moved vertices, and for a also its own box.
struct ClippedLeaf {
    TightBox tight_a, tight_b;
    ChildBox box_a;
    bool near_a = false;       // not apart from the tight box of the whole leaf of b
    std::uint32_t bits_b = 0;  // triangles of b not apart from that of a, all lanes'
};

/// Moves both leaves into the tile. Returns the triangles that are not apart from the tight box of
/// the other leaf. Called by whole warps.
__device__ __forceinline__ ClippedLeaf move_leaves(const PreparedQuery& q, const Leaves& l,
                                                   MovedPair& tile) {
    const unsigned lane = lane_of_thread();
    const float slack = q.c.tight_slack, none[3] = {0, 0, 0};
    const MovedCentres to = move_centres<true>(q, l.a.box.c, l.b.box.c, l.origin);
    ClippedLeaf c;
    float v[9];
    c.tight_a = move_triangle(q.c.a_in_b, l.a.box.c, to.a, l.leaf_a, lane, v);
    for (int k = 0; k < 9; ++k) {
        tile.a[k][lane] = v[k];
    }
    if (lane == 0) {
        tile.d = leaf_d(q.c.d32, l.a.box);
    }
    c.tight_b = move_triangle(q.c.b_in_a, l.b.box.c, to.b, l.leaf_b, lane, nullptr);
    for (int k = 0; k < 9; ++k) {
        tile.b[k][lane] = l.leaf_b.v[k][lane] - l.origin[k % 3];
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

/// Stores in tile.pairs the pairs of triangles whose tight boxes are not proven apart: one lane per
/// triangle of a, the triangles of b in turn. Returns their number.
__device__ __forceinline__ std::uint32_t clip(const PreparedQuery& q, const Leaves& l,
                                              const ClippedLeaf& c, MovedPair& tile) {
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
            tile.pairs[count + rank_in(bits)] = static_cast<std::uint16_t>(lane << 5U | j);
        }
        count += static_cast<std::uint32_t>(__popc(bits));
    }
    return count;
}

/// Vertices in a lane type: its axis loops are unrolled (float) or loops (lanes::RolledFloat).
template <class Lane>
struct LaneVertices {
    sat::V3<Lane> a[3], b[3];
};
template <class Lane>
__device__ __forceinline__ LaneVertices<Lane> in_lane(const Vertices& v) {
    LaneVertices<Lane> out;
    for (int i = 0; i < 3; ++i) {
        out.a[i] = {{v.a[i].x}, {v.a[i].y}, {v.a[i].z}};
        out.b[i] = {{v.b[i].x}, {v.b[i].y}, {v.b[i].z}};
    }
    return out;
}

}  // namespace axg::cuda
