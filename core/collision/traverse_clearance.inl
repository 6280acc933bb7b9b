// SPDX-License-Identifier: Apache-2.0
// The certified clearance: part of traverse.inl. The value of a pair of triangles is the largest
// proven lower bound of its distance (boxes above it, float direction, double direction). The
// clearance is the least value of all pairs, so it does not depend on the order in which they are
// visited, and bounds only skip pairs that could not lower it.

/// Bounds are not negative, so their bits sort as they do. Places fit ten bits.
AXG_HD std::uint64_t key_of(float low, unsigned i, unsigned j) noexcept {
    return (std::uint64_t{__builtin_bit_cast(std::uint32_t, low)} << 16U) | (i << 8U) | j;
}
AXG_HD float low_of(std::uint64_t key) noexcept {
    return __builtin_bit_cast(float, static_cast<std::uint32_t>(key >> 16U));
}

/// Heap sort, ascending: in place, no library call, n log n whatever the data.
static void sort_keys(std::uint64_t* keys, unsigned count) noexcept {
    const auto sink = [keys](unsigned root, unsigned end) {
        const std::uint64_t moving = keys[root];
        for (unsigned child = 2 * root + 1; child < end; child = 2 * root + 1) {
            child += child + 1 < end && keys[child + 1] > keys[child] ? 1 : 0;
            if (keys[child] <= moving) {
                break;
            }
            keys[root] = keys[child];
            root = child;
        }
        keys[root] = moving;
    };
    for (unsigned i = count / 2; i-- > 0;) {
        sink(i, count);
    }
    for (unsigned end = count; end-- > 1;) {
        const std::uint64_t top = keys[0];
        keys[0] = keys[end];
        keys[end] = top;
        sink(0, end);
    }
}

/// Children whose bound is below the best so far, bits.
AXG_HD std::uint32_t below(const float* low, unsigned count, double best) noexcept {
    std::uint32_t bits = 0;
    for (unsigned i = 0; i < count; ++i) {
        bits |= (low[i] < best ? 1U : 0U) << i;
    }
    return bits;
}

/// Pairs of children that could lower the clearance, nearest first, in TraversalLists::keys.
/// Returns how many.
static unsigned nearest_pairs(const Traversal& w, const TreeNode& a, const TreeNode& b, float from,
                              double best) noexcept {
    alignas(64) float low_b[kNodeWidth], low_a[kNodeWidth], low[kNodeWidth];
    low_children(w.a_in_b, moved_box(w.a_in_b, a.box.c, a.box.h), b, low_b);
    low_children(w.b_in_a, moved_box(w.b_in_a, b.box.c, b.box.h), a, low_a);
    std::uint32_t bits_a = below(low_a, a.count, best);
    const std::uint32_t bits_b = below(low_b, b.count, best);
    if (bits_a == 0 || bits_b == 0) {
        return 0;
    }
    MovedChildren moved_a;
    move_children(w.a_in_b, a, bits_a, moved_a);
    unsigned count = 0;
    std::uint64_t* const keys = w.lists.keys.data();
    for (; bits_a != 0; bits_a &= bits_a - 1) {
        const auto i = static_cast<unsigned>(__builtin_ctz(bits_a));
        const Moved m = moved_child(a, moved_a, i);
        low_children(w.a_in_b, m, b, low);
        for (unsigned j = 0; j < b.count; ++j) {
            const float bound =
                lanes::max(lanes::max(low[j], from), lanes::max(low_a[i], low_b[j]));
            if (bound < best) {
                keys[count++] = key_of(bound, i, j);
            }
        }
    }
    sort_keys(keys, count);
    return count;
}

/// The same for two leaves: pairs of triangles by the gaps of their tight boxes along b's axes.
static unsigned nearest_triangles(Traversal& w, NodePair at, const TreeNode& a, const TreeNode& b,
                                  double best) noexcept {
    using lanes::fma, lanes::max;
    alignas(64) float low_b[kNodeWidth], low_a[kNodeWidth], low[kW];
    low_children(w.a_in_b, moved_box(w.a_in_b, a.box.c, a.box.h), b, low_b);
    std::uint32_t bits_b = below(low_b, b.count, best);
    if (bits_b == 0) {
        return 0;
    }
    low_children(w.b_in_a, moved_box(w.b_in_a, b.box.c, b.box.h), a, low_a);
    move_leaf(w, at.a);
    MovedLeaf& m = w.moved;
    spread_corners(w.tree_a, a, m.v, m.boxes);
    std::uint64_t* const keys = w.lists.keys.data();
    unsigned count = 0;
    for (; bits_b != 0; bits_b &= bits_b - 1) {
        const auto j = static_cast<unsigned>(__builtin_ctz(bits_b));
        for (unsigned i = 0; i < a.count; i += kW) {
            V square = V::of(0.0F);
            for (int k = 0; k < 3; ++k) {
                const float c = b.c[k][j] - m.origin[k], h = b.h[k][j] + w.tight_slack;
                const V gap = max(max(V::load(&m.boxes.low[k][i]) - V::of(c + h),
                                      V::of(c - h) - V::load(&m.boxes.high[k][i])),
                                  V::of(0.0F));
                square = fma(gap, gap, square);
            }
            (lanes::sqrt(square) * V::of(1.0F - 0x1p-21F)).store(low);
            for (unsigned k = 0; k < kW && i + k < a.count; ++k) {
                const float bound =
                    lanes::max(lanes::max(low[k], at.low_mm), lanes::max(low_a[i + k], low_b[j]));
                if (bound < best) {
                    keys[count++] = key_of(bound, i + k, j);
                }
            }
        }
    }
    sort_keys(keys, count);
    return count;
}

/// The clearance of pairs that are only proven apart: above 0, and below any length that matters in
/// mm.
inline constexpr double kApart = 0x1p-1000;

/// Certified distance of one pair in double along its closest direction.
[[gnu::noinline]] static double refined_mm(const Traversal& w, const TreeLeaf& a, unsigned i,
                                           const TreeLeaf& b, unsigned j) noexcept {
    const sat::TrianglePair<double> p = double_pair(w, w.query.pose, w.moved.origin, a, i, b, j);
    const sat::Closest<double> closest = sat::closest_direction(p, sat::axes_of(p));
    return sat::certified_distance(p, closest.direction);
}

/// Lowers `best` by the pairs of triangles in `keys`, nearest boxes first. False: stop the
/// traversal.
[[gnu::noinline]] static bool measure_triangles(Traversal& w, const TreeLeaf& a, const TreeLeaf& b,
                                                unsigned count, double& best) noexcept {
    QueryResult& result = w.result;
    if (!count_work(result.triangle_pairs, count, w.lists.triangle_pairs,
                    QueryStatus::too_many_triangle_pairs, result.status)) {
        return false;
    }
    const std::uint64_t* const keys = w.lists.keys.data();
    for (unsigned at = 0; at < count && low_of(keys[at]) < best; at += kW) {
        PairList list;
        list.count = count - at < kW ? count - at : kW;
        for (unsigned k = 0; k < list.count; ++k) {
            list.a[k] = static_cast<std::uint8_t>((keys[at + k] >> 8U) & 0xffU);
            list.b[k] = static_cast<std::uint8_t>(keys[at + k] & 0xffU);
        }
        pad(list);
        const LanePairs picked = lane_pairs(w, b, list, 0);
        const sat::TrianglePair<V> p = sat::scaled_pair(picked.a, picked.b, V::of(w.moved.d));
        const sat::Closest<V> closest = sat::closest_direction(p, sat::axes_of(p));
        alignas(64) float proven[kW];
        sat::certified_distance(p, closest.direction).store(proven);
        for (unsigned k = 0; k < list.count; ++k) {
            double value = lanes::max(proven[k], low_of(keys[at + k]));
            if (!(value < best)) {
                continue;
            }
            value = lanes::max(refined_mm(w, a, list.a[k], b, list.b[k]), value);
            ++result.rechecks;
            if (!(value > 0) && recheck(w, a, list.a[k], b, list.b[k])) {
                value = kApart;  // proven apart along another axis
            }
            if (value < best) {
                best = value;
                result.nearest = {a.triangle[list.a[k]], b.triangle[list.b[k]]};
            }
        }
        if (!(best > 0)) {
            return false;
        }
    }
    return true;
}

/// Opens one pair of nodes, nearest children last so that they are opened first. False: stop the
/// traversal.
static bool visit_nearest(Traversal& w, std::uint32_t& open, NodePair at, double& best) noexcept {
    const TreeNode& a = w.tree_a.nodes.data()[at.a];
    const TreeNode& b = w.tree_b.nodes.data()[at.b];
    const bool leaf_a = a.leaf != kNoLeaf, leaf_b = b.leaf != kNoLeaf;
    std::uint64_t* const keys = w.lists.keys.data();
    unsigned count = 0;
    if (leaf_a && leaf_b) {
        count = nearest_triangles(w, at, a, b, best);
        return count == 0 || measure_triangles(w, w.tree_a.leaves.data()[a.leaf],
                                               w.tree_b.leaves.data()[b.leaf], count, best);
    }
    if (leaf_a == leaf_b) {
        count = nearest_pairs(w, a, b, at.low_mm, best);
    } else {
        alignas(64) float low[kNodeWidth];
        const TreeNode& opened = leaf_a ? b : a;
        const Frame& f = leaf_a ? w.a_in_b : w.b_in_a;
        const Aabb& kept = leaf_a ? a.box : b.box;
        low_children(f, moved_box(f, kept.c, kept.h), opened, low);
        for (unsigned i = 0; i < opened.count; ++i) {
            const float bound = lanes::max(low[i], at.low_mm);
            if (bound < best) {
                keys[count++] = key_of(bound, i, i);
            }
        }
        sort_keys(keys, count);
    }
    while (count-- > 0) {
        const auto i = static_cast<std::uint32_t>((keys[count] >> 8U) & 0xffU);
        const auto j = static_cast<std::uint32_t>(keys[count] & 0xffU);
        const NodePair child{leaf_a ? at.a : a.first_child + i, leaf_b ? at.b : b.first_child + j,
                             low_of(keys[count])};
        if (!push(w, open, child)) {
            return false;
        }
    }
    return true;
}

static void find_clearance(Traversal& w) noexcept {
    double best = w.query.r_mm;
    std::uint32_t open = 0;
    bool go_on = best > 0 && push(w, open, {0, 0, 0});
    while (go_on && open != 0) {
        const NodePair at = w.lists.nodes.data()[--open];
        go_on = !(at.low_mm < best) || visit_nearest(w, open, at, best);
    }
    QueryResult& result = w.result;
    if (result.status == QueryStatus::ok) {
        result.clearance_mm = best > 0 ? best : 0;
        result.proof = best > 0 ? Proof::far : Proof::not_proven;
    }
}
