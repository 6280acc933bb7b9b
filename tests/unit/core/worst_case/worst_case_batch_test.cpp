// SPDX-License-Identifier: Apache-2.0
// The worst-case batch comes to what it says: the CPU's traversal over its trees counts the
// same pairs of nodes, pairs of triangles and rechecks, and they add up to the capacities. No GPU.
#include "core/worst_case/worst_case_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

// Before the templates that call it.
#include "core/collision/lanes_one.hpp"

#include "core/collision/certified_within.hpp"
#include "core/collision/cpu_engine.hpp"
#include "core/collision/pair_test.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kQueries = 512;

/// The traversal of the CPU engine over trees that come from no mesh.
class TreeTraversal {
  public:
    explicit TreeTraversal(const WorstCaseBatch& worst_case)
        : nodes_(1U << 16U), keys_(kNodeWidth * kNodeWidth) {
        for (std::size_t i = 0; i < worst_case.bodies.trees.size(); ++i) {
            const TreeData& tree = worst_case.bodies.trees[i];
            trees_.push_back({tree.nodes, tree.leaves, worst_case.bodies.reach_mm[i]});
        }
    }
    QueryResult run(const Query& query) {
        const TraversalLists lists{nodes_, keys_, 1U << 20U, 1U << 20U, 1U << 20U};
        QueryResult result;
        lane_kernels(LaneSet::widest)->run(trees_, lists, query, result);
        return result;
    }

  private:
    std::vector<NodePair> nodes_;
    std::vector<std::uint64_t> keys_;
    std::vector<Tree> trees_;
};

std::uint32_t entries_of(const BatchWork& work) {
    return std::accumulate(work.level_pairs.begin(), work.level_pairs.end(), work.leaf_pairs);
}

void expect_filled(const Capacities& capacities, std::uint32_t tree_levels,
                   WorstCaseLayout layout) {
    WorstCaseBatch worst_case;
    ASSERT_EQ(make_worst_case_batch(capacities, kQueries, tree_levels, layout, worst_case), "");
    ASSERT_EQ(worst_case.queries.size(), kQueries);
    TreeTraversal traversal(worst_case);
    std::uint64_t node_pairs = 0, triangle_pairs = 0, rechecks = 0, touching = 0;
    for (const Query& query : worst_case.queries) {
        const QueryResult result = traversal.run(query);
        ASSERT_EQ(result.status, QueryStatus::ok);
        node_pairs += result.node_pairs;
        triangle_pairs += result.triangle_pairs;
        rechecks += result.rechecks;
        touching += result.touching;
    }
    const BatchCapacities& batch = capacities.batch;
    EXPECT_EQ(node_pairs, entries_of(worst_case.work));
    EXPECT_EQ(triangle_pairs, worst_case.work.triangle_pairs);
    EXPECT_EQ(rechecks, worst_case.work.rechecks);
    EXPECT_EQ(touching, rechecks) << "each stays undecided in double too: the longest way";
    EXPECT_EQ(worst_case.work.level_pairs[0], kQueries);
    for (std::uint32_t tree_level = 1; tree_level < tree_levels; ++tree_level) {
        EXPECT_EQ(worst_case.work.level_pairs[tree_level], batch.level_pairs) << tree_level;
    }
    EXPECT_EQ(worst_case.work.leaf_pairs, batch.leaf_pairs);
    EXPECT_EQ(worst_case.work.box_rows, batch.box_rows);
    EXPECT_EQ(worst_case.work.triangle_pairs, batch.triangle_pairs);
    EXPECT_EQ(worst_case.work.rechecks, batch.rechecks);
}

TEST(WorstCaseBatch, UsesEveryListToItsLastPlace) {
    for (const std::uint32_t tree_levels : {1U, 2U, 3U, 4U}) {
        for (const WorstCaseLayout layout : {WorstCaseLayout::even, WorstCaseLayout::heaped}) {
            SCOPED_TRACE(std::string(name_of(layout)) + ", levels " + std::to_string(tree_levels));
            expect_filled(Capacities{}, tree_levels, layout);
        }
    }
}

// Capacities that are no multiple of the number of queries are filled to the last place too.
TEST(WorstCaseBatch, NoRemainderIsLeft) {
    Capacities capacities;
    capacities.batch = {1025, 4099, 16389, 65601, 2051};
    expect_filled(capacities, 3, WorstCaseLayout::even);
}

TEST(WorstCaseBatch, SaysWhatDoesNotGoTogether) {
    Capacities capacities;
    capacities.batch.box_rows = 100;
    WorstCaseBatch worst_case;
    EXPECT_NE(make_worst_case_batch(capacities, kQueries, 2, WorstCaseLayout::even, worst_case)
                  .find("box_rows"),
              std::string::npos);
}

// More than fits, of everything: the batch as the GPU sees it overflows on every list.
TEST(WorstCaseBatch, OverflowsEveryList) {
    WorstCaseBatch worst_case;
    const Capacities capacities;
    ASSERT_EQ(
        make_worst_case_batch(capacities, kQueries, 2, WorstCaseLayout::overflowing, worst_case),
        "");
    TreeTraversal traversal(worst_case);
    const QueryResult result = traversal.run(worst_case.queries[0]);
    EXPECT_GT(std::uint64_t{result.node_pairs} * kQueries, capacities.batch.leaf_pairs * 2U);
    EXPECT_GT(std::uint64_t{result.triangle_pairs} * kQueries, capacities.batch.triangle_pairs);
    EXPECT_GT(std::uint64_t{result.rechecks} * kQueries, capacities.batch.rechecks);
}

// The pair of triangles that most entries hold: no stage but the last of float proves it apart.
TEST(WorstCaseBatch, ItsTrianglesTakeTheLongestWay) {
    WorstCaseBatch worst_case;
    ASSERT_EQ(make_worst_case_batch(Capacities{}, kQueries, 1, WorstCaseLayout::even, worst_case),
              "");
    std::uint32_t tried = 0;
    const TreeData& tree_a = worst_case.bodies.trees[0];
    const TreeData& tree_b = worst_case.bodies.trees[1];
    const sat::PairLimits<lanes::Float1> limits{{1e-3F}, {1.00001F}, {1.0001F}};
    for (std::uint32_t child = 0; child < tree_a.nodes[0].count; ++child) {
        const TreeNode& a = tree_a.nodes[tree_a.nodes[0].first_child + child];
        const TreeNode& b = tree_b.nodes[tree_b.nodes[0].first_child + child];
        const TreeLeaf &leaf_a = tree_a.leaves[a.leaf], &leaf_b = tree_b.leaves[b.leaf];
        const std::uint32_t last = a.count - 1;  // the first ones touch
        sat::V3<lanes::Float1> va[3], vb[3];
        for (int v = 0; v < 3; ++v) {
            va[v] = {{leaf_a.v[3 * v][last]},
                     {leaf_a.v[3 * v + 1][last]},
                     {leaf_a.v[3 * v + 2][last] - a.box.c[2]}};
            vb[v] = {{leaf_b.v[3 * v][0]},
                     {leaf_b.v[3 * v + 1][0]},
                     {leaf_b.v[3 * v + 2][0] - a.box.c[2]}};
        }
        if (!sat::apart<true>(va, vb, limits).m || va[0].z.v > 5) {
            continue;  // touches; or leaves that are apart as a whole
        }
        ++tried;
        const auto pair = sat::scaled_pair(va, vb, limits.d);
        const bool told_early =
            sat::separated_shared<true, true>(va, vb, limits.d, limits.r_square).m;
        EXPECT_FALSE(told_early);
        EXPECT_FALSE(sat::separated_17<true>(pair, limits.margin).m);
    }
    EXPECT_GE(tried, 2U);
}

// Rechecks are the longest way only where float can settle the pair neither way.
TEST(WorstCaseBatch, WhatIsRecheckedIsNeitherApartNorCertifiedWithin) {
    WorstCaseBatch worst_case;
    ASSERT_EQ(make_worst_case_batch(Capacities{}, kQueries, 1, WorstCaseLayout::even, worst_case),
              "");
    const TreeData& tree_a = worst_case.bodies.trees[0];
    const TreeData& tree_b = worst_case.bodies.trees[1];
    const sat::PairLimits<float> limits{1e-3F, 1.00001F, 1.0001F};
    std::uint32_t rechecked = 0;
    for (std::uint32_t child = 0; child < tree_a.nodes[0].count; ++child) {
        const TreeNode& a = tree_a.nodes[tree_a.nodes[0].first_child + child];
        const TreeNode& b = tree_b.nodes[tree_b.nodes[0].first_child + child];
        const TreeLeaf &leaf_a = tree_a.leaves[a.leaf], &leaf_b = tree_b.leaves[b.leaf];
        sat::V3<float> va[3], vb[3];
        for (int v = 0; v < 3; ++v) {
            va[v] = {leaf_a.v[3 * v][0], leaf_a.v[3 * v + 1][0],
                     leaf_a.v[3 * v + 2][0] - a.box.c[2]};
            vb[v] = {leaf_b.v[3 * v][0], leaf_b.v[3 * v + 1][0],
                     leaf_b.v[3 * v + 2][0] - a.box.c[2]};
        }
        float edges_square = 0;
        if (sat::apart<true>(va, vb, limits, &edges_square)) {
            continue;
        }
        ++rechecked;
        const auto pair = sat::scaled_pair(va, vb, limits.d);
        EXPECT_FALSE(
            sat::certified_within(pair, edges_square, sat::near_limit(kWorstCaseMarginMm)));
        EXPECT_TRUE(sat::certified_within(pair, edges_square, 1.1F)) << "a hair beyond, and it is";
    }
    EXPECT_EQ(rechecked, 1U) << "one of this question's";
}

}  // namespace
}  // namespace axg
