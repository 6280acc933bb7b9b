// SPDX-License-Identifier: Apache-2.0
// Leaves moved into the other body's frame, in float about their own centre: corners once for all
// their triangles, or every vertex, kW at a time. Part of traverse.inl, after traverse_query.inl:
// no include guard, no namespace of its own. Source: docs/theory/accuracy.md, section 4.

/// Boxes of the triangles of one leaf along the other body's axes: tight, made from moved vertices.
struct TightBoxes {
    float leaf_low[3], leaf_high[3];  // of all its triangles
    // Corners are moved first, for the box of the leaf; low and high follow from them on demand.
    bool is_spread;
    alignas(64) float corner[3][kNodeWidth];
    alignas(64) float low[3][kNodeWidth];
    alignas(64) float high[3][kNodeWidth];
};

/// The box of a leaf, from the boxes of what is moved kW at a time.
struct LeafBox {
    V low[3], high[3];

    AXG_HD void add(bool is_first, int k, V least, V most) noexcept {
        low[k] = is_first ? least : lanes::min(least, low[k]);
        high[k] = is_first ? most : lanes::max(most, high[k]);
    }
    AXG_HD void put(TightBoxes& to) const noexcept {
        for (int k = 0; k < 3; ++k) {
            to.leaf_low[k] = low[k].least();
            to.leaf_high[k] = high[k].most();
        }
    }
};

/// The motion of a leaf into the other body's frame, less an origin, about its own centre.
struct LeafMove {
    const Frame& frame;
    const float* centre;
    float shift[3];  // the moved centre

    AXG_HD LeafMove(const Frame& f, const Pose& p, const Aabb& box, const float* origin) noexcept
        : frame(f), centre(box.c) {
        for (int k = 0; k < 3; ++k) {
            shift[k] = moved_centre(p, k, centre, origin[k]);
        }
    }
};

/// kW vertices, of one array a coordinate, to the leaf's centre.
struct CentredLanes {
    V x, y, z;

    AXG_HD CentredLanes(const float (*v)[kNodeWidth], unsigned at, const float* centre) noexcept
        : x(V::load(&v[0][at]) - V::of(centre[0])),
          y(V::load(&v[1][at]) - V::of(centre[1])),
          z(V::load(&v[2][at]) - V::of(centre[2])) {}
};

/// Moves the vertices of a leaf and stores them in `v`, unless it is null.
AXG_HD void move_vertices(const LeafMove& move, const TreeLeaf& leaf, unsigned count,
                          float (*v)[kNodeWidth], TightBoxes& to) noexcept {
    LeafBox box;
    for (unsigned at = 0; at < count; at += kW) {
        V low[3], high[3];
        for (int i = 0; i < 3; ++i) {
            const CentredLanes from(&leaf.v[3 * i], at, move.centre);
            for (int k = 0; k < 3; ++k) {
                const V c = moved_about(move.frame, k, move.shift[k], from.x, from.y, from.z);
                if (v != nullptr) {
                    c.store(&v[3 * i + k][at]);
                }
                low[k] = i == 0 ? c : lanes::min(c, low[k]);
                high[k] = i == 0 ? c : lanes::max(c, high[k]);
            }
        }
        for (int k = 0; k < 3; ++k) {
            low[k].store(&to.low[k][at]);
            high[k].store(&to.high[k][at]);
            box.add(at == 0, k, low[k], high[k]);
        }
    }
    box.put(to);
    to.is_spread = true;
}

/// Moves corners: the same bits as for the vertices of their triangles.
AXG_HD void move_corners(const LeafMove& move, const LeafCorners& leaf, TightBoxes& to) noexcept {
    LeafBox box;
    for (unsigned at = 0; at < leaf.count; at += kW) {
        const CentredLanes from(leaf.v, at, move.centre);
        for (int k = 0; k < 3; ++k) {
            const V c = moved_about(move.frame, k, move.shift[k], from.x, from.y, from.z);
            c.store(&to.corner[k][at]);
            box.add(at == 0, k, c, c);
        }
    }
    box.put(to);
    to.is_spread = false;
}

/// Copies moved corners to the triangles, and their vertices to `v`, unless it is null.
AXG_HD void spread_corners(const Tree& tree, const TreeNode& node, float (*v)[kNodeWidth],
                           TightBoxes& to) noexcept {
    if (to.is_spread) {
        return;
    }
    const LeafCorners& leaf = tree.corners.data()[node.leaf];
    for (unsigned at = 0; at < node.count; at += kW) {
        for (int k = 0; k < 3; ++k) {
            V low = V::pick(to.corner[k], &leaf.at[0][at]), high = low;
            if (v != nullptr) {
                low.store(&v[k][at]);
            }
            for (int i = 1; i < 3; ++i) {
                const V c = V::pick(to.corner[k], &leaf.at[i][at]);
                if (v != nullptr) {
                    c.store(&v[3 * i + k][at]);
                }
                low = lanes::min(c, low);
                high = lanes::max(c, high);
            }
            low.store(&to.low[k][at]);
            high.store(&to.high[k][at]);
        }
    }
    to.is_spread = true;
}

AXG_HD void move_one(const Tree& tree, const TreeNode& node, const LeafMove& move,
                     float (*v)[kNodeWidth], TightBoxes& to) noexcept {
    if (!tree.corners.empty() && tree.corners.data()[node.leaf].count != 0) {
        move_corners(move, tree.corners.data()[node.leaf], to);
    } else {
        move_vertices(move, tree.leaves.data()[node.leaf], node.count, v, to);
    }
}
