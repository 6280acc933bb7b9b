// SPDX-License-Identifier: Apache-2.0
#include "core/worst_case/worst_case_batch.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "core/worst_case/tree_maker.hpp"

namespace axg {
namespace {

/// Planned work of one query.
struct Share {
    std::uint32_t level_pairs, leaf_pairs, box_rows, triangle_pairs, rechecks;

    friend constexpr auto operator<=>(const Share&, const Share&) = default;
};

/// Rows of boxes and leaves of one query.
struct Deal {
    std::vector<LeafRecipe> leaves;        // children of the root, behind the inner ones
    std::uint32_t root_rows = 0;           // children of a's root
    std::vector<std::uint32_t> deep_rows;  // children of a's node on each deeper level
};

/// The two bodies of a query. Below the root: `share.level_pairs` inner children, all with the
/// same children of their own, one of which is inner again, and so on down to the leaves.
void make_bodies(const Share& share, const Deal& deal, std::uint32_t tree_levels, TreeBodies& out) {
    TreeMaker a(kHalfA), b(kHalfB);
    const std::uint32_t inner = tree_levels > 1 ? share.level_pairs : 0;
    std::uint32_t node_a = 0, node_b = 0;
    for (std::uint32_t tree_level = 0; tree_level < tree_levels; ++tree_level) {
        const std::uint32_t rows =
            tree_level == 0 ? deal.root_rows : deal.deep_rows[tree_level - 1];
        const std::uint32_t going_on = tree_level + 1 == tree_levels ? 0
                                       : tree_level == 0             ? inner
                                                                     : 1;
        const std::uint32_t first_a = a.add_children(node_a, rows);
        const std::uint32_t first_b = b.add_children(node_b, kChildren);
        for (std::uint32_t i = going_on; i < kChildren; ++i) {
            const std::uint32_t recipe = i - going_on;
            if (tree_level == 0 && recipe < deal.leaves.size()) {
                make_leaf_pair(a, first_a + i, b, first_b + i, i, deal.leaves[recipe]);
            } else if (i < rows) {
                make_apart(a, first_a, b, first_b, i);
            } else {  // a has no child in this slot
                make_alone(b, first_b, i);
            }
        }
        node_a = first_a, node_b = first_b;  // the first inner child; the others share its children
        for (std::uint32_t i = 1; tree_level == 1 && i < inner; ++i) {
            a.share_children(1 + i, 1);
            b.share_children(1 + i, 1);
        }
    }
    for (TreeMaker* tree : {&a, &b}) {
        out.trees.push_back(tree->take(tree_levels + 1));
        out.reach_mm.push_back(kLineMm);
    }
}

/// Deals pairs of triangles and rechecks out to a query's pairs of leaves.
std::vector<LeafRecipe> deal_triangles(const Share& share, WorstCaseLayout layout) {
    std::vector<LeafRecipe> leaves(share.leaf_pairs);
    std::uint32_t pairs = share.triangle_pairs, touching = share.rechecks;
    for (std::uint32_t i = 0; i < share.leaf_pairs; ++i) {
        LeafRecipe& leaf = leaves[i];
        const std::uint32_t left = share.leaf_pairs - i;
        const std::uint32_t wanted =
            layout == WorstCaseLayout::heaped ? std::min(pairs, 1024U) : (pairs + left - 1) / left;
        if (wanted == 0) {
            leaf = {kChildren, 1, 0, true};
            continue;
        }
        leaf.b = std::max(1U, std::min(wanted / kChildren, kChildren));
        leaf.a = std::min(wanted / leaf.b, kChildren);
        pairs -= leaf.pairs();
        leaf.touching = std::min(touching / leaf.b, leaf.a);
        touching -= leaf.touching * leaf.b;
    }
    return leaves;
}

/// Deals rows of boxes out to opening and clipping. False: the pairs need more, or the root has too
/// many children.
bool deal_rows(const Share& share, std::uint32_t tree_levels, WorstCaseLayout layout, Deal& deal) {
    const std::uint32_t inner = tree_levels > 1 ? share.level_pairs : 0;
    deal.root_rows = std::max(1U, inner + share.leaf_pairs);
    deal.deep_rows.assign(tree_levels - 1, 1);
    std::uint32_t used = deal.root_rows + inner * (tree_levels - 1);
    for (const LeafRecipe& leaf : deal.leaves) {
        used += leaf.rows();
    }
    if (used > share.box_rows || deal.root_rows > kChildren) {
        return false;
    }
    std::uint32_t left = share.box_rows - used;
    const auto clip = [&] {
        for (LeafRecipe& leaf : deal.leaves) {
            if (leaf.none_near && leaf.rows() == 0 && left > 1) {
                leaf.b = std::min(left, kChildren);
                left -= leaf.b;
            }
        }
    };
    if (layout == WorstCaseLayout::heaped) {
        clip();
    }
    for (std::uint32_t& rows : deal.deep_rows) {
        const std::uint32_t more = inner == 0 ? 0 : std::min(left / inner, kChildren - rows);
        rows += more;
        left -= more * inner;
    }
    const std::uint32_t more = std::min(left, kChildren - deal.root_rows);
    deal.root_rows += more;
    left -= more;
    clip();
    return true;
}

/// Adds the work of a query of this deal to the batch's.
void add_work(const Share& share, const Deal& deal, std::uint32_t tree_levels, BatchWork& work) {
    ++work.level_pairs[0];
    work.box_rows += deal.root_rows;
    for (std::uint32_t tree_level = 1; tree_level < tree_levels; ++tree_level) {
        work.level_pairs[tree_level] += share.level_pairs;
        work.box_rows += share.level_pairs * deal.deep_rows[tree_level - 1];
    }
    for (const LeafRecipe& leaf : deal.leaves) {
        ++work.leaf_pairs;
        work.box_rows += leaf.rows();
        work.triangle_pairs += leaf.pairs();
        work.rechecks += leaf.touching * leaf.b;
    }
}

/// The i-th of `count` equal shares of `all`: whole numbers that add up.
std::uint32_t share_of(std::uint32_t all, std::uint32_t count, std::uint32_t i) {
    return all / count + (i < all % count ? 1 : 0);
}

std::string fill_exactly(const Capacities& capacities, std::uint32_t queries,
                         std::uint32_t tree_levels, WorstCaseLayout layout, WorstCaseBatch& out) {
    const BatchCapacities& batch = capacities.batch;
    struct Made {
        std::uint32_t body = 0;  // the first of two
        Deal deal;
    };
    std::map<Share, Made> made;
    const std::uint32_t level_pairs = std::max(batch.level_pairs, queries);
    for (std::uint32_t i = 0; i < queries; ++i) {
        const Share share{share_of(level_pairs, queries, i), share_of(batch.leaf_pairs, queries, i),
                          share_of(batch.box_rows, queries, i),
                          share_of(batch.triangle_pairs, queries, i),
                          share_of(batch.rechecks, queries, i)};
        const auto [found, is_new] = made.try_emplace(share);
        Deal& deal = found->second.deal;
        if (is_new) {
            found->second.body = static_cast<std::uint32_t>(out.bodies.trees.size());
            deal.leaves = deal_triangles(share, layout);
            if (!deal_rows(share, tree_levels, layout, deal)) {
                return "the capacities of a batch do not go together: box_rows is too small for "
                       "level_pairs and leaf_pairs, or those are more than 32 a question";
            }
            make_bodies(share, deal, tree_levels, out.bodies);
        }
        Query q;
        q.kind = QueryKind::touching;
        q.r_mm = kWorstCaseMarginMm;
        q.mesh_a = found->second.body;
        q.mesh_b = found->second.body + 1;
        out.queries.push_back(q);
        add_work(share, deal, tree_levels, out.work);
    }
    return {};
}

/// Every child near every child, down to triangles that all touch.
void overflow(std::uint32_t queries, std::uint32_t tree_levels, WorstCaseBatch& out) {
    for (int body = 0; body < 2; ++body) {
        TreeMaker tree(kHalfB);
        std::uint32_t node = 0;
        for (std::uint32_t tree_level = 0; tree_level < tree_levels; ++tree_level) {
            const std::uint32_t first = tree.add_children(node, kChildren);
            for (std::uint32_t i = tree_level + 1 < tree_levels ? 1 : 0; i < kChildren; ++i) {
                make_stacked(tree, first + i);
            }
            node = first;
        }
        TreeData data = tree.take(tree_levels + 1);
        for (TreeNode& inner : data.nodes) {
            for (std::uint32_t i = 0; inner.leaf == kNoLeaf && i < kChildren; ++i) {
                inner.c[2][i] = 0;
            }
        }
        out.bodies.trees.push_back(std::move(data));
        out.bodies.reach_mm.push_back(kLineMm);
    }
    Query q;
    q.kind = QueryKind::touching;
    q.r_mm = kWorstCaseMarginMm;
    q.mesh_b = 1;
    out.queries.assign(queries, q);
}

}  // namespace

const char* name_of(WorstCaseLayout layout) noexcept {
    constexpr const char* kNames[] = {"even", "heaped", "overflowing"};
    return kNames[static_cast<unsigned>(layout)];
}

std::string make_worst_case_batch(const Capacities& capacities, std::uint32_t queries,
                                  std::uint32_t tree_levels, WorstCaseLayout layout,
                                  WorstCaseBatch& out) {
    out = {};
    out.bodies.tree_levels = tree_levels;
    std::string fault;
    if (layout == WorstCaseLayout::overflowing) {
        overflow(queries, tree_levels, out);
    } else {
        fault = fill_exactly(capacities, queries, tree_levels, layout, out);
    }
    for (Query& query : out.queries) {
        if (capacities.batch.rechecks == 0) {  // like the queries of a plan without rechecks
            query.kind = QueryKind::farther;
            query.is_float_only = true;
        }
    }
    return fault;
}

}  // namespace axg
