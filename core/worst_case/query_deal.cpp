// SPDX-License-Identifier: Apache-2.0
#include "core/worst_case/query_deal.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace axg {
namespace {

constexpr std::uint32_t kPairsMax = kChildren * kChildren;  // of triangles, in two leaves

/// The i-th of `count` equal parts of `all`: whole numbers that add up.
std::uint32_t part_of(std::uint32_t all, std::uint32_t count, std::uint32_t i) {
    return all / count + (i < all % count ? 1 : 0);
}

LeafRecipe no_triangles() {
    return {.a = kChildren, .b = 1, .touching = 0, .none_near = true};
}

/// Two leaves of which so many pairs are near, or as many fewer as make whole rows.
LeafRecipe leaf_of(std::uint32_t pairs) {
    const std::uint32_t b = std::clamp(pairs / kChildren, 1U, kChildren);
    return {.a = std::min(pairs / b, kChildren), .b = b, .touching = 0, .none_near = false};
}

/// Whole leaves first, the last row in one of its own. Takes from `pairs`.
void heap_triangles(std::uint32_t& pairs, std::span<LeafRecipe> leaves) {
    for (LeafRecipe& leaf : leaves) {
        const std::uint32_t wanted = std::min(pairs, kPairsMax);
        if (wanted == 0) {
            break;
        }
        leaf = leaf_of(wanted);
        pairs -= leaf.pairs();
    }
}

std::vector<LeafRecipe> deal_leaves(const WorkLists& share, CycleLayout layout) {
    std::vector<LeafRecipe> leaves(share.leaf_pairs, no_triangles());
    std::uint32_t pairs = share.triangle_pairs;
    if (layout == CycleLayout::heaped || layout == CycleLayout::rows) {
        heap_triangles(pairs, leaves);
    } else if (layout == CycleLayout::sparse) {
        const auto heaps =
            static_cast<std::uint32_t>(std::min<std::size_t>(leaves.size(), pairs / kPairsMax + 2));
        const std::uint32_t singles = std::min(share.leaf_pairs - heaps, pairs);
        pairs -= singles;
        heap_triangles(pairs, std::span(leaves).first(heaps));
        std::fill_n(leaves.begin() + heaps, singles, leaf_of(1));
    } else {
        const auto count = static_cast<std::uint32_t>(leaves.size());
        for (std::uint32_t i = 0; i < count && pairs != 0; ++i) {
            leaves[i] = leaf_of(std::min(kPairsMax, (pairs + count - i - 1) / (count - i)));
            pairs -= leaves[i].pairs();
        }
    }
    std::uint32_t rechecks = share.rechecks;
    for (LeafRecipe& leaf : leaves) {
        leaf.touching = leaf.none_near ? 0 : std::min(rechecks / leaf.b, leaf.a);
        rechecks -= leaf.touching * leaf.b;
    }
    return leaves;
}

/// Rows in the clipping of leaves of which no triangles are near.
std::uint32_t clip_rows(std::uint32_t rows, std::vector<LeafRecipe>& leaves) {
    for (LeafRecipe& leaf : leaves) {
        if (leaf.none_near && leaf.rows() == 0 && rows > 1) {
            leaf.b = std::min(rows, kChildren);
            rows -= leaf.b;
        }
    }
    return rows;
}

/// Rows beyond those that pairs take: in the opening as far as there is room.
std::uint32_t open_rows(std::uint32_t rows, std::vector<QueryDeal>& out) {
    const auto count = static_cast<std::uint32_t>(out.size());
    std::uint32_t left = rows;
    for (std::uint32_t i = 0; i < count; ++i) {
        QueryDeal& deal = out[i];
        const std::uint32_t room = kChildren * (deal.node_pairs + 1) - deal.rows;
        const std::uint32_t more = std::min(room, (left + count - i - 1) / (count - i));
        deal.rows += more;
        left -= more;
    }
    return left;
}

}  // namespace

WorkLists work_of(const QueryDeal& deal) noexcept {
    WorkLists work{.node_pairs = deal.node_pairs,
                   .leaf_pairs = static_cast<std::uint32_t>(deal.leaves.size()),
                   .box_rows = deal.rows};
    for (const LeafRecipe& leaf : deal.leaves) {
        work.box_rows += leaf.rows();
        work.triangle_pairs += leaf.pairs();
        work.rechecks += leaf.touching * leaf.b;
    }
    return work;
}

std::string deal_group(const WorkLists& share, std::uint32_t queries, CycleLayout layout,
                       std::vector<QueryDeal>& out) {
    std::vector<LeafRecipe> leaves = deal_leaves(share, layout);
    std::uint32_t needed = share.node_pairs + share.leaf_pairs;
    for (const LeafRecipe& leaf : leaves) {
        needed += leaf.rows();
    }
    if (needed > share.box_rows) {
        return "the lists of the plan do not go together: box_rows must be at least node_pairs "
               "and two leaf_pairs";
    }
    std::uint32_t left = share.box_rows - needed;
    left = layout == CycleLayout::heaped ? clip_rows(left, leaves) : left;
    out.assign(queries, {});
    auto next = leaves.begin();
    for (std::uint32_t i = 0; i < queries; ++i) {
        const std::uint32_t count = part_of(share.leaf_pairs, queries, i);
        out[i].node_pairs = part_of(share.node_pairs, queries, i);
        out[i].rows = out[i].node_pairs + count;
        if (out[i].rows > kChildren * (out[i].node_pairs + 1)) {
            return "the lists of the plan do not go together: leaf_pairs are more than 31 times "
                   "node_pairs";
        }
        out[i].leaves.assign(next, next + count);
        next += count;
    }
    for (left = open_rows(left, out); QueryDeal & deal : out) {
        left = clip_rows(left, deal.leaves);
    }
    return {};
}

std::size_t make_bodies(const QueryDeal& deal, TreeBodies& out) {
    TreeMaker a(kHalfA), b(kHalfB);
    std::uint32_t node_a = 0, node_b = 0;
    const std::uint32_t opened = deal.node_pairs + 1;
    const auto leaf_count = static_cast<std::uint32_t>(deal.leaves.size());
    std::uint32_t leaf = 0, left = deal.rows, leaves_left = leaf_count;
    for (std::uint32_t i = 0; i < opened; ++i) {
        const std::uint32_t inner = i + 1 < opened ? 1 : 0, behind = opened - i;
        // The pairs that follow have room for what is left.
        const std::uint32_t rows = std::max((left + behind - 1) / behind, inner);
        const std::uint32_t leaves = std::min((leaves_left + behind - 1) / behind, rows - inner);
        const std::uint32_t first_a = a.add_children(node_a, rows);
        const std::uint32_t first_b = b.add_children(node_b, rows);
        a.fill_boxes(node_a, true);
        b.fill_boxes(node_b, false);
        for (std::uint32_t slot = inner; slot < rows; ++slot) {
            if (slot - inner < leaves) {
                make_full_leaf_pair(a, first_a + slot, b, first_b + slot, slot,
                                    deal.leaves[leaf++]);
            } else {
                make_apart(a, first_a, b, first_b, slot);
            }
        }
        left -= rows;
        leaves_left -= leaves;
        node_a = first_a, node_b = first_b;
    }
    const std::size_t bytes = a.size_bytes() + b.size_bytes();
    for (TreeMaker* tree : {&a, &b}) {
        out.trees.push_back(tree->take(opened + 1));
        out.reach_mm.push_back(kLineMm);
    }
    return bytes;
}

}  // namespace axg
