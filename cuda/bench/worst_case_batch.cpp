// SPDX-License-Identifier: Apache-2.0
#include "cuda/bench/worst_case_batch.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace axg::cuda {
namespace {

// Two triangles whose corners are 1.27 mm apart and which, at a margin of 1 mm, neither the shared
// axes nor the seventeen prove apart: the closest direction alone does. Found by drawing at random;
// tests/unit/worst_case_batch_test holds them to it.
constexpr float kCorner[9] = {-0.625F,   -0.78125F, -0.78125F, -2.875F,  -5.03125F,
                              -5.03125F, -1.875F,   -1.78125F, -2.28125F};
constexpr float kOther[9] = {0, 0, 0, 0.25F, 2.75F, 0.75F, 2, 4.5F, 4};
// Exactly the margin beside kOther, corner to corner: neither certified within it nor apart in
// float, and in double neither.
constexpr float kBeside[9] = {-1, 0, 0, -2.5F, -1, -1.25F, -2, -2.5F, -0.5F};

constexpr float kSlotMm = 40;  // children of a node lie on a line, far more than the margin apart
constexpr std::uint32_t kChildren = kNodeWidth;
constexpr float kLineMm = kSlotMm * kChildren;
// Half widths of the boxes of children: a's have room for a leaf that b's do not reach.
constexpr float kHalfA = 18, kHalfB = 8;
constexpr float kFarMm = 1.0e30F;

/// What one query shall come to.
struct Share {
    std::uint32_t level_pairs, leaf_pairs, box_rows, triangle_pairs, rechecks;

    friend constexpr auto operator<=>(const Share&, const Share&) = default;
};

/// A pair of leaves: every triangle of a is near every one of b; `touching` of a's touch all of b.
/// None near: boxes of the leaves overlap, and those of no two triangles.
struct LeafRecipe {
    std::uint32_t a = kChildren, b = 1, touching = 0;
    bool none_near = false;

    [[nodiscard]] std::uint32_t pairs() const { return none_near ? 0 : a * b; }
    /// Of boxes, in the clipping. With one triangle of b none of a is near all of b.
    [[nodiscard]] std::uint32_t rows() const { return none_near && b == 1 ? 0 : b; }
};

/// Rows of boxes and leaves of one query.
struct Deal {
    std::vector<LeafRecipe> leaves;        // children of the root, behind the inner ones
    std::uint32_t root_rows = 0;           // children of a's root
    std::vector<std::uint32_t> deep_rows;  // children of a's node on each deeper level
};

class TreeMaker {
  public:
    /// @param half_mm  half width of the children's boxes
    explicit TreeMaker(float half_mm) : half_mm_(half_mm) { data_.nodes.emplace_back(blank()); }

    /// Children of `node`: `count` in a row from the index that is returned.
    std::uint32_t add_children(std::uint32_t node, std::uint32_t count) {
        const auto first = static_cast<std::uint32_t>(data_.nodes.size());
        data_.nodes.resize(first + count, blank());
        data_.nodes[node].count = count;
        data_.nodes[node].first_child = first;
        for (std::uint32_t i = 0; i < count; ++i) {
            place_box(data_.nodes[node], i, slot(i), half_mm_);
        }
        return first;
    }
    void share_children(std::uint32_t to, std::uint32_t from) {
        data_.nodes[to] = data_.nodes[from];
    }
    /// A leaf in slot `i` of its parent; `shape_of` gives the nine coordinates of each triangle.
    template <class ShapeOf>
    void make_leaf(std::uint32_t node, std::uint32_t i, std::uint32_t count,
                   const ShapeOf& shape_of) {
        TreeNode& to = data_.nodes[node];
        TreeLeaf leaf{};
        to.leaf = static_cast<std::uint32_t>(data_.leaves.size());
        to.count = count;
        to.box = {{0, 0, slot(i)}, {half_mm_, half_mm_, half_mm_}};
        for (std::uint32_t t = 0; t < kChildren; ++t) {
            const std::uint32_t own = t < count ? t : 0;
            leaf.triangle[t] = next_triangle_ + own;
            std::array<float, 9> v = shape_of(own);
            float low[3] = {kFarMm, kFarMm, kFarMm}, high[3] = {-kFarMm, -kFarMm, -kFarMm};
            for (unsigned k = 0; k < 9; ++k) {
                v[k] += k % 3 == 2 ? slot(i) : 0;
                leaf.v[k][t] = v[k];
                low[k % 3] = std::min(low[k % 3], v[k]);
                high[k % 3] = std::max(high[k % 3], v[k]);
            }
            for (int k = 0; t < count && k < 3; ++k) {  // exact: quarters and 32nds of a mm
                to.c[k][t] = 0.5F * (low[k] + high[k]);
                to.h[k][t] = 0.5F * (high[k] - low[k]);
            }
        }
        next_triangle_ += count;
        data_.leaves.push_back(leaf);
    }
    TreeData take(std::uint32_t depth) {
        data_.depth = depth;
        return std::move(data_);
    }

  private:
    static float slot(std::uint32_t i) { return kSlotMm * static_cast<float>(i); }
    static TreeNode blank() {
        TreeNode node{};
        for (int k = 0; k < 3; ++k) {
            std::fill_n(node.c[k], kChildren, kFarMm);
        }
        node.box = {{0, 0, kLineMm / 2}, {kHalfA, kHalfA, kLineMm}};
        node.leaf = kNoLeaf;
        return node;
    }
    static void place_box(TreeNode& node, std::uint32_t i, float z_mm, float half_mm) {
        for (int k = 0; k < 3; ++k) {
            node.c[k][i] = k == 2 ? z_mm : 0;
            node.h[k][i] = half_mm;
        }
    }

    TreeData data_;
    float half_mm_;
    std::uint32_t next_triangle_ = 0;
};

std::array<float, 9> moved(const float (&shape)[9], float x, float y, float z) {
    std::array<float, 9> v{};
    for (unsigned k = 0; k < 9; ++k) {
        v[k] = shape[k] + (k % 3 == 0 ? x : k % 3 == 1 ? y : z);
    }
    return v;
}

/// Corners of a square for leaves of which no two triangles are near: a's on one diagonal, b's on
/// the other. Tiny triangles, 5 mm apart.
std::array<float, 9> on_diagonal(std::uint32_t t, bool is_a) {
    constexpr float kTiny[9] = {0, 0, 0, 0.25F, 0, 0, 0, 0.25F, 0};
    const float side = t % 2 == 0 ? -2.5F : 2.5F;
    return moved(kTiny, side, is_a ? side : -side, 0);
}

void make_leaf_pair(TreeMaker& a, std::uint32_t node_a, TreeMaker& b, std::uint32_t node_b,
                    std::uint32_t slot, const LeafRecipe& recipe) {
    a.make_leaf(node_a, slot, recipe.a, [&recipe](std::uint32_t t) {
        return recipe.none_near      ? on_diagonal(t, true)
               : t < recipe.touching ? moved(kBeside, 0, 0, 0)
                                     : moved(kCorner, 0, 0, 0);
    });
    b.make_leaf(node_b, slot, recipe.b, [&recipe](std::uint32_t t) {
        return recipe.none_near ? on_diagonal(t, false) : moved(kOther, 0, 0, 0);
    });
}

/// Leaves whose boxes are near as their parents know them, and which are apart once moved: their
/// pair is looked at the longest way, and not listed.
void make_apart(TreeMaker& a, std::uint32_t first_a, TreeMaker& b, std::uint32_t first_b,
                std::uint32_t slot) {
    a.make_leaf(first_a + slot, slot, kChildren,
                [](std::uint32_t) { return moved(kOther, 0, 0, 13); });
    b.make_leaf(first_b + slot, slot, kChildren,
                [](std::uint32_t) { return moved(kOther, 0, 0, 0); });
}

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
            } else {  // no child of a stands there
                b.make_leaf(first_b + i, i, kChildren,
                            [](std::uint32_t) { return moved(kOther, 0, 0, 0); });
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

/// Pairs of triangles and rechecks dealt out to a query's pairs of leaves.
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

/// Rows of boxes dealt out to opening and clipping. False: the pairs alone take more.
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

/// What a query of this deal comes to, added to the batch's.
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
                tree.make_leaf(first + i, 0, kChildren,
                               [](std::uint32_t) { return moved(kOther, 0, 0, 0); });
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
    if (layout == WorstCaseLayout::overflowing) {
        overflow(queries, tree_levels, out);
        return {};
    }
    return fill_exactly(capacities, queries, tree_levels, layout, out);
}

}  // namespace axg::cuda
