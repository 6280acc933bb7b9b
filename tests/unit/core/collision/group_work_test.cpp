// SPDX-License-Identifier: Apache-2.0
// Work charged to groups: every list one place short and exact, for one group and for several; and
// no group notices what another one used.
#include "core/machine/cycle_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/worst_case/tree_maker.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"

namespace axg {
namespace {

using test::shifted;

constexpr std::uint32_t kAmple = 1U << 30U;
constexpr WorkLists kAmpleShare{kAmple, kAmple, kAmple, kAmple, kAmple};

struct List {
    const char* name;
    std::uint32_t WorkLists::*list;
    QueryStatus full;
};
constexpr List kLists[] = {
    {"node pairs", &WorkLists::node_pairs, QueryStatus::too_many_node_pairs},
    {"leaf pairs", &WorkLists::leaf_pairs, QueryStatus::too_many_leaf_pairs},
    {"box rows", &WorkLists::box_rows, QueryStatus::too_many_box_rows},
    {"triangle pairs", &WorkLists::triangle_pairs, QueryStatus::too_many_triangle_pairs},
    {"rechecks", &WorkLists::rechecks, QueryStatus::too_many_rechecks}};

std::vector<Mesh> lumpy_balls() {
    test::Draw draw(4);
    return {test::lumpy_ball(draw, 20, 30, 0.2), test::lumpy_ball(draw, 24, 40, 0.2)};
}

class GroupWorkTest : public testing::TestWithParam<LaneSet> {
  protected:
    /// Two bodies with all that a query can cost, and far all the same.
    Query near_miss(std::uint16_t group) {
        Query q;
        q.mesh_b = 1;
        q.r_mm = 0.5;
        q.group = group;
        double x = 90;
        do {
            x -= 0.125;
            q.pose = shifted(x, 5, 2);
        } while (test::run_query(engine, q).proof == Proof::far);
        q.pose = shifted(x + 0.125, 5, 2);
        return q;
    }
    static Query clear(std::uint16_t group) {
        Query q;
        q.mesh_b = 1;
        q.group = group;
        q.pose = shifted(1000, 0, 0);
        return q;
    }
    std::vector<QueryResult> run(std::span<const Query> queries, std::span<GroupWork> groups) {
        std::vector<QueryResult> results(queries.size());
        engine.engine()(queries, results, groups);
        return results;
    }
    /// What one query alone needs.
    WorkLists demand(Query query) {
        query.group = 0;
        GroupWork group{.share = kAmpleShare};
        run({&query, 1}, {&group, 1});
        return group.used;
    }

    CpuEngine engine = *test::engine_over(lumpy_balls(), {}, GetParam());
};

INSTANTIATE_TEST_SUITE_P(Lanes, GroupWorkTest, testing::ValuesIn(test::lane_sets()),
                         [](const auto& set) {
                             return set.param == LaneSet::avx512 ? "avx512"
                                    : set.param == LaneSet::avx2 ? "avx2"
                                                                 : "neon";
                         });

TEST_P(GroupWorkTest, AGroupOneShortOfAnyListProvesNothingAndNoOtherNotices) {
    const WorkLists need = demand(near_miss(0));
    ASSERT_GT(need.node_pairs, 0U);
    ASSERT_GT(need.leaf_pairs, 0U);
    ASSERT_GT(need.box_rows, 0U);
    ASSERT_GT(need.triangle_pairs, 0U);
    for (const std::uint16_t groups : {std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{7}}) {
        for (const List& list : kLists) {
            if (need.*list.list == 0) {
                continue;
            }
            for (const bool is_short : {false, true}) {
                // Two queries a group; the last group is the one that may be short.
                std::vector<Query> queries;
                std::vector<GroupWork> shares(groups, {.share = kAmpleShare});
                for (std::uint16_t i = 0; i < groups; ++i) {
                    queries.insert(queries.end(), {clear(i), near_miss(i)});
                    shares[i].share.*list.list = need.*list.list;
                }
                shares.back().share.*list.list -= is_short ? 1 : 0;
                const std::vector<QueryResult> results = run(queries, shares);
                for (std::size_t i = 0; i < results.size(); ++i) {
                    const bool is_lost = is_short && queries[i].group == groups - 1;
                    EXPECT_EQ(results[i].proof, is_lost ? Proof::not_proven : Proof::far)
                        << list.name << ", group " << queries[i].group << " of " << groups;
                    EXPECT_EQ(results[i].status, is_lost ? list.full : QueryStatus::ok);
                }
            }
        }
    }
}

TEST_P(GroupWorkTest, WhatWasProvenBeforeTheShareWasSpentDoesNotCount) {
    const WorkLists need = demand(near_miss(0));
    const Query queries[] = {near_miss(0), near_miss(0)};
    GroupWork group{.share = kAmpleShare};
    group.share.triangle_pairs = 2 * need.triangle_pairs - 1;
    for (const QueryResult& result : run(queries, {&group, 1})) {
        EXPECT_EQ(result.status, QueryStatus::too_many_triangle_pairs);
        EXPECT_EQ(result.proof, Proof::not_proven);
    }
    // Nor does it in a later call of the same stage.
    const Query more = clear(0);
    EXPECT_EQ(run({&more, 1}, {&group, 1})[0].proof, Proof::not_proven);
}

TEST_P(GroupWorkTest, UsedAddsUpOverCallsAndLeavesTheShareAlone) {
    const Query query = near_miss(0);
    const WorkLists need = demand(query);
    GroupWork group{.share = kAmpleShare};
    run({&query, 1}, {&group, 1});
    run({&query, 1}, {&group, 1});
    EXPECT_EQ(group.used.triangle_pairs, 2 * need.triangle_pairs);
    EXPECT_EQ(group.used.box_rows, 2 * need.box_rows);
    EXPECT_EQ(group.share, kAmpleShare);
}

TEST_P(GroupWorkTest, CountingAllCostsAFarQueryTheSameAndATouchingOneNoLess) {
    Query touching = near_miss(0);
    touching.pose = shifted(20, 5, 2);
    for (const Query& query : {near_miss(0), touching, clear(0)}) {
        engine.set_counts_all(false);
        const bool is_far = test::run_query(engine, query).proof == Proof::far;
        const WorkLists lazy = demand(query);
        engine.set_counts_all(true);
        const WorkLists all = demand(query);
        for (const List& list : kLists) {
            EXPECT_LE(lazy.*list.list, all.*list.list) << list.name;
            if (is_far) {
                EXPECT_EQ(lazy.*list.list, all.*list.list) << list.name;
            }
        }
    }
    engine.set_counts_all(false);
    EXPECT_GT(demand(touching).triangle_pairs, 0U);
}

TEST_P(GroupWorkTest, CountingAllReportsTheFirstFullListOfTheTable) {
    engine.set_counts_all(true);
    const Query query = near_miss(0);
    for (std::size_t first = 0; first + 1 < std::size(kLists); ++first) {
        GroupWork group{.share = kAmpleShare};
        for (std::size_t i = first; i + 1 < std::size(kLists); ++i) {
            group.share.*kLists[i].list = 0;
        }
        EXPECT_EQ(run({&query, 1}, {&group, 1})[0].status, kLists[first].full);
    }
}

// Nobody asks for the rest of a grid once one box of it is near.
TEST_P(GroupWorkTest, AGroupThatNeedsAllIsLeftAtItsFirstNearQuery) {
    Query touching = near_miss(0);
    touching.pose = shifted(20, 5, 2);
    Query other = touching;
    other.group = 1;
    const Query queries[] = {clear(0), touching, near_miss(0), other, clear(1)};
    GroupWork groups[] = {{.share = kAmpleShare, .needs_all = true}, {.share = kAmpleShare}};
    const std::vector<QueryResult> results = run(queries, groups);
    EXPECT_EQ(results[0].proof, Proof::far);
    EXPECT_EQ(results[2].proof, Proof::not_proven) << "left out";
    EXPECT_EQ(results[2].status, QueryStatus::ok);
    EXPECT_EQ(results[4].proof, Proof::far) << "the other group wants every result";
}

TEST_P(GroupWorkTest, ManyPairsOfNodesAreNeverForgotten) {
    Capacities few;
    few.node_pairs = 1;  // no place but for one pair, and a share for any number
    CpuEngine tight = *test::engine_over(lumpy_balls(), few, GetParam());
    Query touching = near_miss(0);
    touching.pose = shifted(0, 0, 0);
    for (const bool counts_all : {false, true}) {
        tight.set_counts_all(counts_all);
        GroupWork group{.share = {UINT32_MAX, kAmple, kAmple, kAmple, kAmple}};
        QueryResult result;
        tight.engine()({&touching, 1}, {&result, 1}, {&group, 1});
        EXPECT_EQ(result.proof, Proof::not_proven);
    }
}

TEST_P(GroupWorkTest, QueriesInFloatAloneNeedNoRoomForRechecks) {
    Query query = near_miss(0);
    query.is_float_only = true;
    query.pose = shifted(20, 5, 2);
    GroupWork group{.share = kAmpleShare};
    group.share.rechecks = 0;
    EXPECT_EQ(run({&query, 1}, {&group, 1})[0].status, QueryStatus::ok);
    EXPECT_EQ(group.used.rechecks, 0U);
}

/// So many copies of one triangle, all in one leaf.
Mesh heap_of(std::uint32_t count, const float (&v)[9]) {
    const Triangle one{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
    Mesh mesh;
    mesh.triangles.assign(count, one);
    return mesh;
}

// A single pair takes as long as all lanes full.
TEST_P(GroupWorkTest, EachPairOfLeavesIsChargedWholeBatchesOfTriangles) {
    struct Case {
        std::uint32_t a, b, charged;
    };
    for (const Case& one : {Case{1, 1, 16}, Case{15, 1, 16}, Case{4, 4, 16}, Case{17, 1, 32},
                            Case{32, 32, 1024}, Case{31, 31, 976}}) {
        CpuEngine heaps =
            *test::engine_over({heap_of(one.a, kCorner), heap_of(one.b, kOther)}, {}, GetParam());
        Query query;
        query.mesh_b = 1;
        query.r_mm = 1;
        GroupWork group{.share = kAmpleShare};
        QueryResult result;
        heaps.engine()({&query, 1}, {&result, 1}, {&group, 1});
        EXPECT_EQ(result.proof, Proof::far);
        EXPECT_EQ(group.used.triangle_pairs, one.charged) << one.a << " by " << one.b;
        group = {.share = kAmpleShare};
        group.share.triangle_pairs = one.charged - 1;
        heaps.engine()({&query, 1}, {&result, 1}, {&group, 1});
        EXPECT_EQ(result.status, QueryStatus::too_many_triangle_pairs) << one.a << " by " << one.b;
    }
}

/// A strip of small triangles that share no corner.
Mesh strip_of(std::uint32_t count, float z) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float x = static_cast<float>(i);
        mesh.triangles.push_back({{x, 0, z}, {x + 0.5F, 0, z}, {x, 0.5F, z}});
    }
    return mesh;
}

// Moving a leaf costs three times as much where its corners are not listed.
TEST_P(GroupWorkTest, ALeafWithTooManyCornersToListIsChargedMore) {
    struct Case {
        std::uint32_t a, b, leaf_pairs;
    };
    for (const Case& one : {Case{10, 10, 1}, Case{11, 10, 3}, Case{10, 11, 3}, Case{11, 11, 5}}) {
        CpuEngine strips =
            *test::engine_over({strip_of(one.a, 0), strip_of(one.b, 0.75F)}, {}, GetParam());
        Query query;
        query.mesh_b = 1;
        query.r_mm = 0.5;
        GroupWork group{.share = kAmpleShare};
        QueryResult result;
        strips.engine()({&query, 1}, {&result, 1}, {&group, 1});
        EXPECT_EQ(result.proof, Proof::far);
        EXPECT_EQ(group.used.leaf_pairs, one.leaf_pairs) << one.a << " by " << one.b;
    }
}

// Every leaf of a is near b's box, so each is a row where the roots are opened.
TEST_P(GroupWorkTest, RowsThatMoveSuchALeafAreChargedMoreToo) {
    TreeData charged = build_tree(strip_of(640, 0).triangles);
    TreeData alike = charged;
    std::uint32_t more = 0;
    for (std::uint32_t i = 1; i < charged.nodes.size(); ++i) {
        ASSERT_NE(charged.nodes[i].leaf, kNoLeaf);
        EXPECT_EQ(charged.nodes[i].more != 0, charged.nodes[i].count * 3 > kNodeWidth);
        more += charged.nodes[i].more;
        alike.nodes[i].more = 0;
    }
    ASSERT_GT(more, 0U);
    const TreeData other = build_tree(strip_of(640, 0.75F).triangles);
    std::uint32_t rows[2];
    for (const TreeData* a : {&charged, &alike}) {
        const Tree trees[] = {{a->nodes, a->leaves, 641}, {other.nodes, other.leaves, 641}};
        CpuEngine strips = *CpuEngine::over_trees(trees, {}, GetParam());
        Query query;
        query.mesh_b = 1;
        query.r_mm = 0.5;
        query.pose = shifted(0, 0, 0.2499);  // far, and no box is
        GroupWork group{.share = kAmpleShare};
        QueryResult result;
        strips.engine()({&query, 1}, {&result, 1}, {&group, 1});
        rows[a == &alike ? 1 : 0] = group.used.box_rows;
    }
    EXPECT_EQ(rows[0] - rows[1], more);
}

TEST(CycleWork, SharesAreAMatterOfTheNumberOfGroupsAlone) {
    constexpr WorkLists kStage{10, 9, 8, 112, 2};
    EXPECT_EQ(share_of(kStage, 3), (WorkLists{3, 3, 2, 32, 0})) << "whole batches of triangles";
    EXPECT_EQ(share_of(kStage, 1), kStage);
}

TEST(CycleWork, TreesAreAsDeepAsTheirQueriesFit) {
    EXPECT_EQ(tree_depth(126, 1, TreeForm::whole), 6U);
    EXPECT_EQ(tree_depth(125, 1, TreeForm::whole), 5U);
    EXPECT_EQ(tree_depth(504, 4, TreeForm::whole), 6U);
    EXPECT_EQ(tree_depth(128, 1, TreeForm::leaves), 7U);
    EXPECT_EQ(tree_depth(127, 1, TreeForm::leaves), 6U);
    EXPECT_EQ(tree_depth(15, 8, TreeForm::leaves), 0U);
    EXPECT_EQ(tree_depth(UINT32_MAX, 1, TreeForm::leaves), 31U);
    EXPECT_EQ(tree_depth(10, 0, TreeForm::leaves), 0U);
}

TEST(CycleWork, AllStagesOfAPlanAreTheCycle) {
    constexpr WorkLists kCycle{1023, 1024, 4097, 16384, UINT32_MAX};
    for (const std::uint32_t stages : {1U, 2U, 3U}) {
        const CyclePlan plan = plan_of(stages, 8, 512, kCycle);
        for (const List& list : kLists) {
            std::uint64_t sum = 0;
            for (std::uint32_t i = 0; i < kStagesMax; ++i) {
                sum += plan.lists[i].*list.list;
                EXPECT_EQ(plan.lists[i].*list.list != 0, i < stages);
            }
            EXPECT_EQ(sum, kCycle.*list.list) << stages;
        }
        EXPECT_EQ(plan.queries[0], 24U) << "three a pair";
    }
}

TEST(CycleWork, EachStageHasThePartsOfItsOwn) {
    constexpr WorkLists kCycle{160, 320, 1600, 3200, 32};
    const CyclePlan two = plan_of(2, 8, 512, kCycle), three = plan_of(3, 8, 512, kCycle);
    EXPECT_EQ(two.lists[0], (WorkLists{10, 20, 100, 200, 2}));
    EXPECT_EQ(two.lists[1], (WorkLists{150, 300, 1500, 3000, 30}));
    EXPECT_EQ(three.lists[0], two.lists[0]);
    EXPECT_EQ(three.lists[1], (WorkLists{30, 240, 300, 2800, 24}));
    EXPECT_EQ(three.lists[2], (WorkLists{120, 60, 1200, 200, 6}));
    EXPECT_EQ(two.queries, (std::array<std::uint32_t, 3>{24, 512, 0}));
    EXPECT_EQ(three.queries, (std::array<std::uint32_t, 3>{24, 32, 512}));
}

}  // namespace
}  // namespace axg
