// SPDX-License-Identifier: Apache-2.0
// The traversal of two trees: one source for every instruction set. The including file defines
// AXG_TRAVERSE_LANES (the float lanes) and AXG_TRAVERSE_NAMESPACE. Nothing here allocates, throws,
// or calls what another unit could have compiled.
//
// Descent of a pair of nodes: children of b against a's own box, children of a against b's own box,
// then every child left against every child left. Two leaves: pairs of triangles whose boxes are
// left go to the certified test. Where only one node is a leaf, only the other is opened. The set
// of pairs reached depends on nothing else.

#include <cstdint>

#include "core/base/fetch.hpp"
#include "core/base/finite.hpp"
#include "core/base/host_device.hpp"
#include "core/collision/double_test.hpp"
#include "core/collision/lane_kernels.hpp"
#include "core/collision/pair_test.hpp"

namespace axg::AXG_TRAVERSE_NAMESPACE {

using V = AXG_TRAVERSE_LANES;
inline constexpr unsigned kW = V::kWidth;
inline constexpr std::uint32_t kLaneBits = kW == 32 ? ~0U : (1U << kW) - 1U;
inline constexpr unsigned kLeafPairs = kNodeWidth * kNodeWidth;

#include "core/collision/box_test.inl"
#include "core/collision/traverse_query.inl"

#include "core/collision/move_leaves.inl"

/// One leaf of a in b's frame, less an origin near it. Made once for all leaves of b that it meets
/// in a row.
struct MovedLeaf {
    alignas(64) float v[9][kNodeWidth];  // as soon as boxes.is_spread
    float origin[3];
    float d;  // of scale_of
    TightBoxes boxes;
    std::uint32_t node = kNoLeaf;  // which node of a this is
};

inline constexpr unsigned kTightKept = 32;  // leaves of b whose boxes along a's axes are stored

struct Traversal : QueryConstants {
    // The arrays stay as they are until they are written: clearing them would cost more than a
    // query whose bodies are far apart.
    AXG_HD Traversal(const Tree& a, const Tree& b, const TraversalLists& some_lists, const Query& q,
                     QueryResult& a_result) noexcept
        : tree_a(a), tree_b(b), lists(some_lists), query(q), result(a_result) {}

    const Tree& tree_a;
    const Tree& tree_b;
    const TraversalLists& lists;
    const Query& query;
    QueryResult& result;
    bool stop_early;
    MovedLeaf moved;
    TightBoxes boxes_b[kTightKept];
    std::uint32_t boxes_b_node[kTightKept];  // which nodes of b those are
    std::uint32_t boxes_b_used = 0;          // one bit for each of them that is filled
    Pose inverse_pose;                       // as soon as one is filled
};

AXG_HD void move_leaf(Traversal& w, std::uint32_t node) noexcept {
    MovedLeaf& to = w.moved;
    if (to.node == node) {
        return;
    }
    const TreeNode& a = w.tree_a.nodes.data()[node];
    const Moved box = moved_box(w.a_in_b, a.box.c, a.box.h);
    for (int k = 0; k < 3; ++k) {
        to.origin[k] = box.c[k];
    }
    to.d = leaf_d(w.d32, a.box);
    move_one(w.tree_a, a, LeafMove(w.a_in_b, w.query.pose, a.box, to.origin), to.v, to.boxes);
    to.node = node;
}

/// Boxes of a leaf of b along a's axes, in a's frame.
AXG_HD TightBoxes& boxes_of_b(Traversal& w, std::uint32_t node) noexcept {
    const std::uint32_t place = node % kTightKept;
    TightBoxes& to = w.boxes_b[place];
    const bool is_kept = (w.boxes_b_used >> place & 1U) != 0 && w.boxes_b_node[place] == node;
    if (!is_kept) {
        static constexpr float kNone[3] = {0, 0, 0};
        if (w.boxes_b_used == 0) {
            w.inverse_pose = inverse(w.query.pose);
        }
        const TreeNode& b = w.tree_b.nodes.data()[node];
        move_one(w.tree_b, b, LeafMove(w.b_in_a, w.inverse_pose, b.box, kNone), nullptr, to);
        w.boxes_b_node[place] = node;
        w.boxes_b_used |= 1U << place;
    }
    return to;
}

/// kW pairs of triangles, local vertices.
struct LanePairs {
    sat::V3<V> a[3], b[3];
};

AXG_HD LanePairs lane_pairs(const Traversal& w, const TreeLeaf& b, const PairList& list,
                            unsigned at) noexcept {
    LanePairs p;
    for (int v = 0; v < 3; ++v) {
        V ca[3], cb[3];
        for (int k = 0; k < 3; ++k) {
            ca[k] = V::pick(w.moved.v[3 * v + k], &list.a[at]);
            cb[k] = V::pick(b.v[3 * v + k], &list.b[at]) - V::of(w.moved.origin[k]);
        }
        p.a[v] = {ca[0], ca[1], ca[2]};
        p.b[v] = {cb[0], cb[1], cb[2]};
    }
    return p;
}

[[gnu::noinline]] static bool recheck(const Traversal& w, const TreeLeaf& a, unsigned i,
                                      const TreeLeaf& b, unsigned j) noexcept {
    const sat::TrianglePair<double> p = double_pair(w, w.query.pose, w.moved.origin, a, i, b, j);
    return w.has_margin ? sat::apart_in_double<true>(p, w.margin64)
                        : sat::apart_in_double<false>(p, 0.0);
}

AXG_HD bool count_work(std::uint32_t& counter, std::uint32_t more, std::uint32_t capacity,
                       QueryStatus overflow, QueryStatus& status) noexcept {
    counter += more;
    if (counter > capacity) {
        status = overflow;
        return false;
    }
    return true;
}

/// Charges the query's group; does nothing for a query without a group. False: the group's share is
/// spent, and none of its queries can be proven.
AXG_HD bool charge(Traversal& w, std::uint32_t WorkLists::*list, std::uint32_t more) noexcept {
    GroupWork* const group = w.lists.group;
    if (group == nullptr) {
        return true;
    }
    std::uint32_t& used = group->used.*list;
    used = more > ~0U - used ? ~0U : used + more;
    if (used <= group->share.*list || w.lists.counts_all) {
        return true;
    }
    w.result.status = first_full(*group);
    return false;
}

/// The certified test on a list of pairs of triangles. False: stop the traversal.
template <bool kMargin>
[[gnu::noinline]] static bool test_triangles(Traversal& w, const TreeLeaf& a, const TreeLeaf& b,
                                             PairList& list) noexcept {
    QueryResult& result = w.result;
    if (!count_work(result.triangle_pairs, list.count, w.lists.triangle_pairs,
                    QueryStatus::too_many_triangle_pairs, result.status) ||
        !charge(w, &WorkLists::triangle_pairs, charged_pairs(list.count))) {
        return false;
    }
    pad(list);
    const sat::PairLimits<V> limits{V::of(w.moved.d), V::of(w.margin), V::of(w.r_square)};
    for (unsigned at = 0; at < list.count; at += kW) {
        const LanePairs p = lane_pairs(w, b, list, at);
        std::uint32_t left = ~sat::apart<kMargin>(p.a, p.b, limits).bits() & kLaneBits;
        if (list.count - at < kW) {
            left &= (1U << (list.count - at)) - 1U;
        }
        for (; left != 0; left &= left - 1) {
            const unsigned k = at + static_cast<unsigned>(__builtin_ctz(left));
            if (w.query.kind == QueryKind::farther && w.query.is_float_only) {
                ++result.touching;
                if (w.stop_early) {
                    return false;
                }
                continue;
            }
            if (!count_work(result.rechecks, 1, w.lists.rechecks, QueryStatus::too_many_rechecks,
                            result.status) ||
                !charge(w, &WorkLists::rechecks, 1)) {
                return false;
            }
            if (recheck(w, a, list.a[k], b, list.b[k])) {
                continue;
            }
            if (result.touching < w.query.list.size()) {
                w.query.list.data()[result.touching] = {a.triangle[list.a[k]],
                                                        b.triangle[list.b[k]]};
            }
            ++result.touching;
            if (w.stop_early) {
                return false;
            }
        }
    }
    return true;
}

AXG_HD bool count_node_pair(Traversal& w) noexcept {
    return count_work(w.result.node_pairs, 1, w.lists.node_pairs, QueryStatus::too_many_node_pairs,
                      w.result.status);
}

AXG_HD bool are_leaves(const Traversal& w, NodePair at) noexcept {
    return w.tree_a.nodes.data()[at.a].leaf != kNoLeaf &&
           w.tree_b.nodes.data()[at.b].leaf != kNoLeaf;
}

AXG_HD bool charge_leaves(Traversal& w, NodePair at) noexcept {
    return charge(w, &WorkLists::leaf_pairs,
                  charged_leaves(w.tree_a.nodes.data()[at.a], w.tree_b.nodes.data()[at.b]));
}

/// The pair of roots is on no list, unless they are leaves.
AXG_HD bool list_pair(Traversal& w, NodePair at) noexcept {
    return count_node_pair(w) &&
           (are_leaves(w, at) ? charge_leaves(w, at) : charge(w, &WorkLists::node_pairs, 1));
}

AXG_HD bool push(Traversal& w, std::uint32_t& open, NodePair pair) noexcept {
    if (!list_pair(w, pair)) {
        return false;
    }
    if (open == w.lists.nodes.size()) {  // a group's share may exceed the places
        charge(w, &WorkLists::node_pairs, ~0U);
        w.result.status = QueryStatus::too_many_node_pairs;  // never far: this pair is forgotten
        return w.lists.counts_all;
    }
    w.lists.nodes.data()[open++] = pair;
    return true;
}

/// Opens b alone (a is a leaf) or a alone (b is a leaf).
AXG_HD bool open_one(Traversal& w, std::uint32_t& open, NodePair at, const TreeNode& a,
                     const TreeNode& b) noexcept {
    const bool opens_b = a.leaf != kNoLeaf;
    std::uint32_t bits =
        opens_b ? near_children_bits(w.a_in_b, moved_box(w.a_in_b, a.box.c, a.box.h), b)
                : near_children_bits(w.b_in_a, moved_box(w.b_in_a, b.box.c, b.box.h), a);
    for (; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::uint32_t>(__builtin_ctz(bits));
        const NodePair child =
            opens_b ? NodePair{at.a, b.first_child + i, 0} : NodePair{a.first_child + i, at.b, 0};
        if (!push(w, open, child)) {
            return false;
        }
    }
    return true;
}

/// Whether the tight box of a leaf as a whole is apart from a node's own box.
AXG_HD bool apart_from(const TightBoxes& tight, const Aabb& box, const float* origin,
                       float slack) noexcept {
    int apart = 0;  // counted, not branched on: the three axes are about equally likely
    for (int k = 0; k < 3; ++k) {
        const float c = box.c[k] - origin[k], h = box.h[k] + slack;
        apart += (tight.leaf_low[k] > c + h ? 1 : 0) + (c - h > tight.leaf_high[k] ? 1 : 0);
    }
    return apart != 0;
}

/// Triangles of a node (a leaf) whose own boxes are near the tight box of the other leaf as a
/// whole.
AXG_HD std::uint32_t near_whole(const TreeNode& node, const TightBoxes& tight, const float* origin,
                                float slack) noexcept {
    using lanes::either, lanes::greater;
    std::uint32_t bits = 0;
    for (unsigned at = 0; at < node.count; at += kW) {
        auto apart = greater(V::of(0.0F), V::of(0.0F));
        for (int k = 0; k < 3; ++k) {
            const V c = V::load(&node.c[k][at]) - V::of(origin[k]);
            const V h = V::load(&node.h[k][at]) + V::of(slack);
            apart = either(apart, either(greater(V::of(tight.leaf_low[k]), c + h),
                                         greater(c - h, V::of(tight.leaf_high[k]))));
        }
        bits |= (~apart.bits() & kLaneBits) << at;
    }
    return bits;
}

/// Triangles of a near triangle j of b, kW at a time: tight boxes along b's axes, then along a's.
AXG_HD std::uint32_t near_one(const Traversal& w, const TreeNode& a, const TreeNode& b,
                              const TightBoxes& tight_b, unsigned j, unsigned at) noexcept {
    using lanes::either, lanes::greater;
    const TightBoxes& tight_a = w.moved.boxes;
    auto apart = greater(V::of(0.0F), V::of(0.0F));
    for (int k = 0; k < 3; ++k) {
        const float c = b.c[k][j] - w.moved.origin[k], h = b.h[k][j] + w.tight_slack;
        apart = either(apart, either(greater(V::load(&tight_a.low[k][at]), V::of(c + h)),
                                     greater(V::of(c - h), V::load(&tight_a.high[k][at]))));
    }
    if (lanes::all(apart)) {
        return 0;
    }
    for (int k = 0; k < 3; ++k) {
        const V c = V::load(&a.c[k][at]), h = V::load(&a.h[k][at]) + V::of(w.tight_slack);
        apart = either(apart, either(greater(V::of(tight_b.low[k][j]), c + h),
                                     greater(c - h, V::of(tight_b.high[k][j]))));
    }
    return ~apart.bits() & kLaneBits;
}

/// Pairs of triangles of two leaves whose tight boxes, along b's axes and along a's, are not proven
/// apart. False: stop the traversal.
AXG_HD bool near_triangles(Traversal& w, NodePair at, PairList& out) noexcept {
    static constexpr float kNone[3] = {0, 0, 0};
    const TreeNode& a = w.tree_a.nodes.data()[at.a];
    const TreeNode& b = w.tree_b.nodes.data()[at.b];
    out.count = 0;
    move_leaf(w, at.a);
    MovedLeaf& moved = w.moved;
    if (apart_from(moved.boxes, b.box, moved.origin, w.tight_slack)) {
        return true;
    }
    std::uint32_t near_b = near_whole(b, moved.boxes, moved.origin, w.tight_slack);
    if (near_b == 0) {  // before b's leaf is moved, which costs more
        return true;
    }
    TightBoxes& tight_b = boxes_of_b(w, at.b);
    if (apart_from(tight_b, a.box, kNone, w.tight_slack)) {
        return true;
    }
    const std::uint32_t near_a = near_whole(a, tight_b, kNone, w.tight_slack);
    if (near_a == 0) {
        return true;
    }
    spread_corners(w.tree_a, a, moved.v, moved.boxes);
    spread_corners(w.tree_b, b, nullptr, tight_b);
    for (; near_b != 0; near_b &= near_b - 1) {
        if (!charge(w, &WorkLists::box_rows, 1)) {
            return false;
        }
        const auto j = static_cast<unsigned>(__builtin_ctz(near_b));
        for (unsigned i = 0; i < a.count; i += kW) {
            const std::uint32_t wanted = (near_a >> i) & kLaneBits;
            std::uint32_t bits = wanted == 0 ? 0 : wanted & near_one(w, a, b, tight_b, j, i);
            for (; bits != 0; bits &= bits - 1) {
                out.a[out.count] =
                    static_cast<std::uint8_t>(i + static_cast<unsigned>(__builtin_ctz(bits)));
                out.b[out.count++] = static_cast<std::uint8_t>(j);
            }
        }
    }
    return true;
}

/// Prefetches the memory that moving a leaf reads.
AXG_HD void fetch_leaf(const Tree& tree, const TreeNode& node) noexcept {
    if (node.leaf == kNoLeaf) {
        return;
    }
    if (!tree.corners.empty() && node.more == 0) {
        fetch(tree.corners.data()[node.leaf]);
    } else {
        fetch(tree.leaves.data()[node.leaf].v);
    }
}

/// Two leaves: the triangles themselves. False: stop the traversal.
[[gnu::noinline]] static bool visit_leaves(Traversal& w, NodePair at) noexcept {
    fetch(w.tree_b.nodes.data()[at.b]);
    fetch(w.tree_a.nodes.data()[at.a]);
    fetch_leaf(w.tree_b, w.tree_b.nodes.data()[at.b]);
    PairList pairs;
    if (!near_triangles(w, at, pairs)) {
        return false;
    }
    if (pairs.count == 0) {
        return true;
    }
    const TreeNode& a = w.tree_a.nodes.data()[at.a];
    const TreeNode& b = w.tree_b.nodes.data()[at.b];
    const TreeLeaf& tri_a = w.tree_a.leaves.data()[a.leaf];
    const TreeLeaf& tri_b = w.tree_b.leaves.data()[b.leaf];
    return w.has_margin ? test_triangles<true>(w, tri_a, tri_b, pairs)
                        : test_triangles<false>(w, tri_a, tri_b, pairs);
}

/// Children of b near child i of a, out of `wanted`: boxes along b's axes and a's, and where the
/// child is a leaf also its tight box.
AXG_HD std::uint32_t near_child(Traversal& w, const TreeNode& a, const MovedChildren& moved_a,
                                unsigned i, const TreeNode& b, std::uint32_t wanted) noexcept {
    const MovedLanes m = every_lane(moved_child(a, moved_a, i));
    std::uint32_t bits = 0;
    for (unsigned at = 0; at < b.count; at += kW) {
        if (((wanted >> at) & kLaneBits) != 0) {
            bits |= near_children_lanes<false>(w.a_in_b, m, b, at) << at;
        }
    }
    bits &= wanted;
    const std::uint32_t child = a.first_child + i;
    if (bits != 0 && w.tree_a.nodes.data()[child].leaf != kNoLeaf) {
        move_leaf(w, child);
        bits &= near_whole(b, w.moved.boxes, w.moved.origin, w.tight_slack);
    }
    return bits;
}

/// Opens both nodes: every child of a left against every child of b left. Tests pairs of leaves at
/// once, while the leaf of a is moved, and pushes the others.
AXG_HD bool open_both(Traversal& w, std::uint32_t& open, const TreeNode& a,
                      const TreeNode& b) noexcept {
    const std::uint32_t bits_b =
        near_children_bits(w.a_in_b, moved_box(w.a_in_b, a.box.c, a.box.h), b);
    if (bits_b == 0) {
        return true;
    }
    std::uint32_t bits_a = near_children_bits(w.b_in_a, moved_box(w.b_in_a, b.box.c, b.box.h), a);
    if (bits_a == 0) {
        return true;
    }
    MovedChildren moved_a;
    move_children(w.a_in_b, a, bits_a, moved_a);
    const TreeNode* const children = &w.tree_a.nodes.data()[a.first_child];
    for (std::uint32_t left = bits_a; left != 0; left &= left - 1) {
        __builtin_prefetch(&children[__builtin_ctz(left)].leaf);
    }
    for (; bits_a != 0; bits_a &= bits_a - 1) {
        const auto i = static_cast<unsigned>(__builtin_ctz(bits_a));
        if (!charge(w, &WorkLists::box_rows, charged_rows(children[i]))) {
            return false;
        }
        const std::uint32_t behind = bits_a & (bits_a - 1);
        if (behind != 0) {
            fetch_leaf(w.tree_a, children[__builtin_ctz(behind)]);
        }
        std::uint32_t bits = near_child(w, a, moved_a, i, b, bits_b);
        for (; bits != 0; bits &= bits - 1) {
            const NodePair child{a.first_child + i,
                                 b.first_child + static_cast<std::uint32_t>(__builtin_ctz(bits)),
                                 0};
            if (are_leaves(w, child) ? !list_pair(w, child) || !visit_leaves(w, child)
                                     : !push(w, open, child)) {
                return false;
            }
        }
    }
    return true;
}

AXG_HD bool visit(Traversal& w, std::uint32_t& open, NodePair at) noexcept {
    const TreeNode& a = w.tree_a.nodes.data()[at.a];
    const TreeNode& b = w.tree_b.nodes.data()[at.b];
    const bool leaf_a = a.leaf != kNoLeaf, leaf_b = b.leaf != kNoLeaf;
    if (leaf_a && leaf_b) {
        return visit_leaves(w, at);
    }
    return leaf_a || leaf_b ? open_one(w, open, at, a, b) : open_both(w, open, a, b);
}

static void traverse_pairs(Traversal& w) noexcept {
    std::uint32_t open = 0;
    constexpr NodePair kRoots{0, 0, 0};
    bool go_on = count_node_pair(w) && (!are_leaves(w, kRoots) || charge_leaves(w, kRoots)) &&
                 visit(w, open, kRoots);
    while (go_on && open != 0) {
        const NodePair at = w.lists.nodes.data()[--open];
        go_on = visit(w, open, at);
    }
    if (w.result.status == QueryStatus::ok && w.result.touching == 0) {
        w.result.proof = Proof::far;
    }
}

#include "core/collision/traverse_clearance.inl"

static void run(std::span<const Tree> trees, const TraversalLists& lists, const Query& q,
                QueryResult& result) noexcept {
    result.status = QueryStatus::bad_query;
    if (q.mesh_a >= trees.size() || q.mesh_b >= trees.size() || !usable(q)) {
        return;
    }
    Traversal w(trees.data()[q.mesh_a], trees.data()[q.mesh_b], lists, q, result);
    if (w.tree_a.nodes.empty() || w.tree_b.nodes.empty()) {
        return;
    }
    result.status = QueryStatus::ok;
    set_constants(w, q, w.tree_a.reach_mm, w.tree_b.reach_mm);
    w.stop_early = q.kind == QueryKind::farther && !lists.counts_all;
    if (q.kind == QueryKind::clearance) {
        find_clearance(w);
    } else {
        traverse_pairs(w);
    }
}

}  // namespace axg::AXG_TRAVERSE_NAMESPACE
