// SPDX-License-Identifier: Apache-2.0
// Boxes of one body against boxes of the other, many at a time. Part of traverse.inl: no include
// guard, no namespace of its own.
//
// Every claim of "apart" and every lower bound is a theorem: all roundings of this page together
// stay below Frame::slack (docs/theory/accuracy.md, section "Boxes"), which also holds the margin
// and the pose's own error.

/// Body X seen from body Y's frame, in float.
struct Frame {
    float r[3][3], size_r[3][3], t[3];  // size_r = |r|
    float slack;
};

/// One box of X in Y's frame: centre and half extents along Y's axes, and its half widths along its
/// own.
struct Moved {
    float c[3], e[3], h[3];
};

/// The same, one box a lane.
struct MovedLanes {
    V c[3], e[3], h[3];
};

/// All children of a node of X, moved into Y's frame.
struct MovedChildren {
    alignas(64) float c[3][kNodeWidth];
    alignas(64) float e[3][kNodeWidth];
};

AXG_HD Moved moved_box(const Frame& f, const float* c, const float* h) noexcept {
    Moved m;
    for (int k = 0; k < 3; ++k) {
        m.c[k] = __builtin_fmaf(
            f.r[k][0], c[0],
            __builtin_fmaf(f.r[k][1], c[1], __builtin_fmaf(f.r[k][2], c[2], f.t[k])));
        m.e[k] = __builtin_fmaf(f.size_r[k][0], h[0],
                                __builtin_fmaf(f.size_r[k][1], h[1], f.size_r[k][2] * h[2]));
        m.h[k] = h[k];
    }
    return m;
}

AXG_HD MovedLanes every_lane(const Moved& m) noexcept {
    MovedLanes out;
    for (int k = 0; k < 3; ++k) {
        out.c[k] = V::of(m.c[k]);
        out.e[k] = V::of(m.e[k]);
        out.h[k] = V::of(m.h[k]);
    }
    return out;
}

/// Only lanes that hold one of the `wanted` children are computed.
AXG_HD void move_children(const Frame& f, const TreeNode& node, std::uint32_t wanted,
                          MovedChildren& to) noexcept {
    using lanes::fma;
    for (unsigned at = 0; at < kNodeWidth; at += kW) {
        if (((wanted >> at) & kLaneBits) == 0) {
            continue;
        }
        const V cx = V::load(&node.c[0][at]), cy = V::load(&node.c[1][at]),
                cz = V::load(&node.c[2][at]);
        const V hx = V::load(&node.h[0][at]), hy = V::load(&node.h[1][at]),
                hz = V::load(&node.h[2][at]);
        for (int k = 0; k < 3; ++k) {
            fma(V::of(f.r[k][0]), cx,
                fma(V::of(f.r[k][1]), cy, fma(V::of(f.r[k][2]), cz, V::of(f.t[k]))))
                .store(&to.c[k][at]);
            fma(V::of(f.size_r[k][0]), hx,
                fma(V::of(f.size_r[k][1]), hy, V::of(f.size_r[k][2]) * hz))
                .store(&to.e[k][at]);
        }
    }
}

/// Lanes in which the box of X and the box of Y (centre c, half widths h) are not proven apart,
/// bits from 0. Fifteen axes: Y's, X's, and their crosses (Gottschalk, Lin, Manocha 1996), each
/// with the slack added.
template <bool kCrosses>
AXG_HD std::uint32_t near_lanes(const Frame& f, const MovedLanes& m, const V* c,
                                const V* h) noexcept {
    using lanes::abs, lanes::either, lanes::fma, lanes::greater;
    const V slack = V::of(f.slack);
    V d[3];
    auto apart = greater(V::of(0.0F), V::of(0.0F));
    for (int k = 0; k < 3; ++k) {
        d[k] = m.c[k] - c[k];
        apart = either(apart, greater(abs(d[k]), (m.e[k] + slack) + h[k]));
    }
    if (lanes::all(apart)) {
        return 0;
    }
    for (int k = 0; k < 3; ++k) {
        const V along =
            fma(V::of(f.r[0][k]), d[0], fma(V::of(f.r[1][k]), d[1], V::of(f.r[2][k]) * d[2]));
        const V radius =
            fma(V::of(f.size_r[0][k]), h[0],
                fma(V::of(f.size_r[1][k]), h[1], fma(V::of(f.size_r[2][k]), h[2], m.h[k] + slack)));
        apart = either(apart, greater(abs(along), radius));
    }
    if (!kCrosses || lanes::all(apart)) {
        return ~apart.bits() & kLaneBits;
    }
    for (int i = 0; i < 3; ++i) {  // X's axis i ...
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; ++j) {  // ... crossed with Y's axis j
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const V own =
                fma(m.h[i1], V::of(f.size_r[j][i2]), fma(m.h[i2], V::of(f.size_r[j][i1]), slack));
            const V along = fma(d[j2], V::of(f.r[j1][i]), -(d[j1] * V::of(f.r[j2][i])));
            const V radius =
                fma(h[j1], V::of(f.size_r[j2][i]), fma(h[j2], V::of(f.size_r[j1][i]), own));
            apart = either(apart, greater(abs(along), radius));
        }
    }
    return ~apart.bits() & kLaneBits;
}

/// Children [at, at + kW) of `node` (of Y) not proven apart from the moved box, bits from 0.
template <bool kCrosses>
AXG_HD std::uint32_t near_children_lanes(const Frame& f, const MovedLanes& m, const TreeNode& node,
                                         unsigned at) noexcept {
    const V c[3] = {V::load(&node.c[0][at]), V::load(&node.c[1][at]), V::load(&node.c[2][at])};
    const V h[3] = {V::load(&node.h[0][at]), V::load(&node.h[1][at]), V::load(&node.h[2][at])};
    return near_lanes<kCrosses>(f, m, c, h);
}

/// All children of `node` (of Y) not proven apart from the moved box, bits.
AXG_HD std::uint32_t near_children_bits(const Frame& f, const Moved& m,
                                        const TreeNode& node) noexcept {
    const MovedLanes lanes_m = every_lane(m);
    std::uint32_t bits = 0;
    for (unsigned at = 0; at < node.count; at += kW) {
        bits |= near_children_lanes<true>(f, lanes_m, node, at) << at;
    }
    return bits;
}

/// One of the moved children.
AXG_HD Moved moved_child(const TreeNode& node, const MovedChildren& moved, unsigned i) noexcept {
    Moved m;
    for (int k = 0; k < 3; ++k) {
        m.c[k] = moved.c[k][i];
        m.e[k] = moved.e[k][i];
        m.h[k] = node.h[k][i];
    }
    return m;
}

/// Pairs of children of two nodes, or of triangles of two leaves, by number.
struct PairList {
    std::uint8_t a[kLeafPairs + kNodeWidth], b[kLeafPairs + kNodeWidth];
    unsigned count;
};

/// Fills the last lanes with copies of the last pair; callers cut them off.
AXG_HD void pad(PairList& list) noexcept {
    for (unsigned i = list.count; i % kW != 0; ++i) {
        list.a[i] = list.a[list.count - 1];
        list.b[i] = list.b[list.count - 1];
    }
}

/// Certified lower bounds of the distance between the moved box and the boxes of Y, mm; 0 where
/// they may touch. The larger of the gaps along Y's axes and along X's, each as a vector length.
AXG_HD V low_bounds(const Frame& f, const MovedLanes& m, const V* c, const V* h) noexcept {
    using lanes::abs, lanes::fma, lanes::max;
    const V slack = V::of(f.slack), zero = V::of(0.0F);
    V d[3], in_y = zero, in_x = zero;
    for (int k = 0; k < 3; ++k) {
        d[k] = m.c[k] - c[k];
        const V gap = max(abs(d[k]) - ((m.e[k] + slack) + h[k]), zero);
        in_y = fma(gap, gap, in_y);
    }
    for (int k = 0; k < 3; ++k) {
        const V along =
            fma(V::of(f.r[0][k]), d[0], fma(V::of(f.r[1][k]), d[1], V::of(f.r[2][k]) * d[2]));
        const V radius =
            fma(V::of(f.size_r[0][k]), h[0],
                fma(V::of(f.size_r[1][k]), h[1], fma(V::of(f.size_r[2][k]), h[2], m.h[k] + slack)));
        const V gap = max(abs(along) - radius, zero);
        in_x = fma(gap, gap, in_x);
    }
    return lanes::sqrt(max(in_y, in_x)) * V::of(1.0F - 0x1p-21F);
}

/// Lower bounds of all children of a node against the moved box.
AXG_HD void low_children(const Frame& f, const Moved& m, const TreeNode& node,
                         float* out) noexcept {
    const MovedLanes lanes_m = every_lane(m);
    for (unsigned at = 0; at < node.count; at += kW) {
        const V c[3] = {V::load(&node.c[0][at]), V::load(&node.c[1][at]), V::load(&node.c[2][at])};
        const V h[3] = {V::load(&node.h[0][at]), V::load(&node.h[1][at]), V::load(&node.h[2][at])};
        low_bounds(f, lanes_m, c, h).store(&out[at]);
    }
}
