// SPDX-License-Identifier: Apache-2.0
#include "core/worst_case/query_deal.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>

namespace axg {
namespace {

constexpr std::uint32_t kPairsMax = kChildren * kChildren;  // of triangles, in two leaves
constexpr std::uint32_t kTimesMax = 8;                      // leaves of b near one of a

/// The i-th of `count` equal parts of `all`: whole numbers that add up.
std::uint32_t part_of(std::uint32_t all, std::uint32_t count, std::uint32_t i) {
    return all / count + (i < all % count ? 1 : 0);
}

LeafRecipe no_triangles() {
    return {.a = kChildren, .b = 1, .touching = 0, .none_near = true};
}

/// Two leaves with `pairs` near pairs, or fewer so that they fill whole rows; whole batches stay
/// whole batches.
LeafRecipe leaf_of(std::uint32_t pairs) {
    const std::uint32_t b = std::clamp(pairs / kChildren, 1U, kChildren);
    return {.a = std::min(pairs / b, kChildren), .b = b, .touching = 0, .none_near = false};
}

/// Fills whole leaves first, and puts the last row in a leaf of its own. Reduces `pairs`.
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

/// Rows that remain for pairs of leaves with one pair of triangles each, if every other list is
/// full and as many leaves as possible share a row.
std::uint32_t rows_for_singles(const WorkLists& share, std::uint32_t heaps) {
    const std::uint32_t taken = share.node_pairs + share.triangle_pairs / kChildren + 2 * heaps +
                                share.leaf_pairs / kTimesMax + 2;
    return share.box_rows - std::min(share.box_rows, taken);
}

std::vector<LeafRecipe> deal_leaves(const WorkLists& share, CycleLayout layout) {
    std::vector<LeafRecipe> leaves(share.leaf_pairs, no_triangles());
    std::uint32_t pairs = share.triangle_pairs;
    if (layout == CycleLayout::heaped || layout == CycleLayout::rows) {
        heap_triangles(pairs, leaves);
    } else if (layout == CycleLayout::sparse) {
        const auto heaps =
            static_cast<std::uint32_t>(std::min<std::size_t>(leaves.size(), pairs / kPairsMax + 2));
        const std::uint32_t singles = std::min(
            {share.leaf_pairs - heaps, pairs / kTriangleBatch, rows_for_singles(share, heaps)});
        pairs -= singles * kTriangleBatch;
        heap_triangles(pairs, std::span(leaves).first(heaps));
        std::fill_n(leaves.begin() + heaps, singles, leaf_of(1));
    } else {
        const auto count = static_cast<std::uint32_t>(leaves.size());
        for (std::uint32_t i = 0; i < count && pairs != 0; ++i) {
            const std::uint32_t each = (pairs + count - i - 1) / (count - i);
            leaves[i] = leaf_of(std::min(kPairsMax, charged_pairs(each)));
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

/// Puts each leaf of a in a row of its own or, if that needs more than `rows`, as few equal ones
/// in one row as possible. Empty: kTimesMax a row need more than `rows` too.
std::vector<LeafRow> deal_leaf_rows(std::vector<LeafRecipe> leaves, std::uint32_t rows) {
    std::sort(leaves.begin(), leaves.end(), std::greater<>());
    std::vector<LeafRow> out;
    for (std::uint32_t times = 1; times <= kTimesMax; ++times) {
        out.clear();
        for (const LeafRecipe& leaf : leaves) {
            const bool is_like = !out.empty() && out.back().recipe == leaf;
            if (is_like && out.back().times < times) {
                ++out.back().times;
            } else {
                out.push_back({leaf, 1});
            }
        }
        if (out.size() <= rows) {
            return out;
        }
    }
    return {};
}

/// Puts rows in the clipping of leaves without near triangles. Returns the rest.
std::uint32_t clip_rows(std::uint32_t rows, std::vector<LeafRow>& leaves) {
    for (LeafRow& leaf : leaves) {
        const std::uint32_t each = std::min(rows / leaf.times, kChildren);
        if (leaf.recipe.none_near && leaf.recipe.rows() == 0 && each > 1) {
            leaf.recipe.b = each;
            rows -= each * leaf.times;
        }
    }
    return rows;
}

/// Puts rows beyond those of the pairs in the opening while there is room. Returns the rest.
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

/// The children of an opened pair of nodes. All pairs but the last contain one more pair that is
/// opened.
struct OpenedPair {
    bool has_inner = false;
    std::uint32_t leaf_rows = 0, aparts = 0;

    [[nodiscard]] std::uint32_t rows() const { return (has_inner ? 1 : 0) + leaf_rows + aparts; }
};

/// Spreads rows and leaves in equal parts, so that later pairs have room for the rest.
std::vector<OpenedPair> spread(const QueryDeal& deal) {
    std::vector<OpenedPair> out(deal.node_pairs + 1);
    auto leaves_left = static_cast<std::uint32_t>(deal.leaves.size());
    std::uint32_t left = deal.rows, behind = deal.node_pairs + 1;
    for (OpenedPair& pair : out) {
        pair.has_inner = behind > 1;
        const std::uint32_t inner = pair.has_inner ? 1 : 0;
        const std::uint32_t rows = std::max((left + behind - 1) / behind, inner);
        pair.leaf_rows = std::min((leaves_left + behind - 1) / behind, rows - inner);
        pair.aparts = rows - inner - pair.leaf_rows;
        left -= rows;
        leaves_left -= pair.leaf_rows;
        --behind;
    }
    return out;
}

/// Whether no node has more than kChildren children.
bool has_room(const QueryDeal& deal) {
    auto leaf = deal.leaves.begin();
    for (const OpenedPair& pair : spread(deal)) {
        std::uint32_t children = pair.rows();
        for (std::uint32_t i = 0; i < pair.leaf_rows; ++i) {
            children += (leaf++)->times - 1;
        }
        if (children > kChildren) {
            return false;
        }
    }
    return true;
}

}  // namespace

WorkLists work_of(const QueryDeal& deal) noexcept {
    WorkLists work{.node_pairs = deal.node_pairs, .leaf_pairs = 0, .box_rows = deal.rows};
    for (const auto& [recipe, times] : deal.leaves) {
        work.leaf_pairs += times;
        work.box_rows += times * recipe.rows();
        work.triangle_pairs += times * charged_pairs(recipe.pairs());
        work.rechecks += times * recipe.touching * recipe.b;
    }
    return work;
}

std::string deal_group(const WorkLists& share, std::uint32_t queries, CycleLayout layout,
                       std::vector<QueryDeal>& out) {
    const std::vector<LeafRecipe> recipes = deal_leaves(share, layout);
    std::uint32_t needed = share.node_pairs;
    for (const LeafRecipe& recipe : recipes) {
        needed += recipe.rows();
    }
    std::vector<LeafRow> leaves =
        deal_leaf_rows(recipes, share.box_rows - std::min(share.box_rows, needed));
    const auto rows = static_cast<std::uint32_t>(leaves.size());
    if (needed + rows > share.box_rows || leaves.empty() != recipes.empty()) {
        return "the lists of the plan do not go together: state more box_rows, or fewer of the "
               "others";
    }
    std::uint32_t left = share.box_rows - needed - rows;
    left = layout == CycleLayout::heaped ? clip_rows(left, leaves) : left;
    out.assign(queries, {});
    auto next = leaves.begin();
    for (std::uint32_t i = 0; i < queries; ++i) {
        const std::uint32_t count = part_of(rows, queries, i);
        out[i].node_pairs = part_of(share.node_pairs, queries, i);
        out[i].rows = out[i].node_pairs + count;
        out[i].leaves.assign(next, next + count);
        next += count;
    }
    for (left = open_rows(left, out); QueryDeal & deal : out) {
        left = clip_rows(left, deal.leaves);
        if (!has_room(deal)) {
            return "the lists of the plan do not go together: state more node_pairs, or fewer "
                   "leaf_pairs";
        }
    }
    return {};
}

std::size_t make_bodies(const QueryDeal& deal, TreeBodies& out) {
    TreeMaker a(kHalfA), b(kHalfB);
    std::uint32_t node_a = 0, node_b = 0;
    auto leaf = deal.leaves.begin();
    for (const OpenedPair& pair : spread(deal)) {
        const std::uint32_t rows = pair.rows(), inner = pair.has_inner ? 1 : 0;
        std::uint32_t more = 0;  // leaves of b beyond the first of a row
        for (std::uint32_t i = 0; i < pair.leaf_rows; ++i) {
            more += leaf[i].times - 1;
        }
        const std::uint32_t first_a = a.add_children(node_a, rows);
        const std::uint32_t first_b = b.add_children(node_b, rows + more);
        a.fill_boxes(node_a, true);
        b.fill_boxes(node_b, false);
        std::uint32_t place = rows;  // of the next of those
        for (std::uint32_t slot = inner; slot < rows; ++slot) {
            if (slot - inner >= pair.leaf_rows) {
                make_apart(a, first_a, b, first_b, slot);
                continue;
            }
            make_full_leaf_of_a(a, first_a + slot, slot, leaf->recipe);
            make_full_leaf_of_b(b, first_b + slot, slot, leaf->recipe);
            for (std::uint32_t i = 1; i < leaf->times; ++i, ++place) {
                make_full_leaf_of_b(b, first_b + place, slot, leaf->recipe);
                b.move_box(node_b, place, slot);
            }
            ++leaf;
        }
        node_a = first_a, node_b = first_b;
    }
    std::size_t bytes = a.size_bytes() + b.size_bytes();
    for (TreeMaker* tree : {&a, &b}) {
        out.trees.push_back(tree->take(deal.node_pairs + 2));
        bytes += out.trees.back().leaves.size() * sizeof(LeafCorners);
        out.reach_mm.push_back(kLineMm);
    }
    return bytes;
}

}  // namespace axg
