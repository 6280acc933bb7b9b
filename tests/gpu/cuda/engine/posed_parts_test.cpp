// SPDX-License-Identifier: Apache-2.0
// Parts of boxes that the GPU poses get the results of the queries that the host would have posed,
// field by field, and their groups are charged the same. AXG_COUNT: batches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "core/collision/known_answer.hpp"
#include "core/collision/query_tree.hpp"
#include "tests/support/cuda_fixture.hpp"
#include "tests/support/engine_parity.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kQueriesMax = 544, kGroups = 5;

/// Boxes of some trees, and queries behind them.
struct Parts {
    std::vector<QueryTree> trees;
    std::vector<TreeRoot> roots;
    std::vector<Query> queries;
    std::uint32_t depth = 0;

    /// Some may be far without a look: the host's stand-ins for those are charged, and they not.
    [[nodiscard]] bool counts_alike() const {
        return std::none_of(trees.begin(), trees.end(),
                            [](const QueryTree& tree) { return tree.is_apart; });
    }
    [[nodiscard]] PartQueries asked() const { return {trees, roots, depth}; }
    /// As the host poses them. What is far without a look is a query about nothing near.
    [[nodiscard]] std::vector<Query> posed() const {
        std::vector<Query> out;
        for (std::uint32_t i = 0; i < asked().count(); ++i) {
            const TreeRoot& root = roots[i >> depth];
            Query query;
            if (part_query({trees[root.tree], root, depth, i & ((1U << depth) - 1)}, query)) {
                query.pose = {};
                query.pose.t[0] = 1e5;
                query.r_mm = 0;
            }
            out.push_back(query);
        }
        out.insert(out.end(), queries.begin(), queries.end());
        return out;
    }
};

QueryTree random_tree(test::Draw& draw, std::uint32_t depth, bool may_be_apart) {
    QueryTree tree;
    tree.is_float_only = true;
    tree.may_be_pruned = draw.below(2) == 0;
    tree.is_apart = may_be_apart && draw.below(2) == 0;
    tree.joints = draw.below(kTreeJointsMax + 1);
    tree.split = draw.below(tree.joints + 1);
    tree.r_mm = draw.below(3) == 0 ? 0 : draw.between(0, 3);
    tree.pose_error_mm = 1e-6;
    for (std::uint32_t i = 0; i < tree.joints; ++i) {
        const Pose turn = test::random_rotation(draw);
        tree.joint[i] = {{turn.r[0][0], turn.r[1][0], turn.r[2][0]},
                         {draw.between(-50, 50), draw.between(-50, 50), draw.between(-50, 50)},
                         draw.below(2) == 0 ? 1.0 : -1.0,
                         draw.below(2) == 0};
        tree.cut[i] = {draw.between(0, 2), draw.between(-40, 0), draw.between(0, 40)};
    }
    for (std::uint32_t level = 0; level < depth; ++level) {
        tree.quarter[level] = draw.between(0, 0.5);
        if (tree.joints != 0) {
            tree.cut[draw.below(tree.joints)].levels |= 1U << level;
        }
    }
    for (std::uint32_t i = 0; i <= tree.joints; ++i) {
        tree.fixed[i] = test::random_rotation(draw);
        for (double& t : tree.fixed[i].t) {
            t = draw.between(-15, 15);
        }
    }
    return tree;
}

Parts random_parts(test::Draw& draw, std::uint32_t meshes) {
    Parts out;
    out.depth = 1 + draw.below(7);
    const bool may_be_apart = draw.below(3) == 0;
    const std::uint32_t behind = draw.below(4);
    const std::uint32_t most = (kQueriesMax - behind) >> out.depth;
    const std::uint32_t roots = 1 + draw.below(most), changes = 1 + draw.below(20);
    for (std::uint32_t i = 0; i < roots; ++i) {
        const bool is_new = out.trees.empty() || draw.below(changes) == 0;
        if (is_new && out.trees.size() < kQueryTreesMax) {
            out.trees.push_back(random_tree(draw, out.depth, may_be_apart));
        }
        TreeRoot root;
        for (double& centre : root.centre) {
            centre = draw.between(-3, 3);
        }
        root.mesh_a = draw.below(meshes);
        root.mesh_b = draw.below(meshes);
        root.pruned_a = draw.below(meshes);
        root.pruned_b = draw.below(meshes);
        root.tree = static_cast<std::uint16_t>(out.trees.size() - 1);
        root.group = static_cast<std::uint16_t>(draw.below(kGroups));
        out.roots.push_back(root);
    }
    for (std::uint32_t i = 0; i < behind; ++i) {
        Query query = test::random_query(draw, meshes);
        query.kind = QueryKind::farther;
        query.is_float_only = true;
        query.group = static_cast<std::uint16_t>(draw.below(kGroups));
        out.queries.push_back(query);
    }
    return out;
}

TEST(CudaPosedParts, GetTheResultsOfQueriesThatTheHostPosed) {
    test::Draw draw{test::printed_seed(81)};
    const std::vector<Mesh> meshes = test::random_surfaces(draw);
    CudaOptions options;
    options.queries_max = kQueriesMax;
    AXG_CUDA_ENGINE_OR_SKIP(gpu, meshes, test::ample(), options);
    const std::uint32_t count = test::number_from("AXG_COUNT", 200);
    std::uint64_t far = 0, near = 0, lost = 0, most_trees = 0;
    for (std::uint32_t batch = 0; batch < count; ++batch) {
        const Parts parts = random_parts(draw, static_cast<std::uint32_t>(meshes.size()));
        const std::vector<Query> posed = parts.posed();
        const bool is_short = batch % 2 == 0 && parts.counts_alike();
        const std::uint32_t room = is_short ? 300 : 1U << 30U;
        std::vector<GroupWork> groups(kGroups, {.share = {room, room, room, room, room}});
        std::vector<GroupWork> wanted_groups = groups;
        std::vector<QueryResult> wanted(posed.size()), found(posed.size());
        gpu.run(posed, wanted, wanted_groups);
        gpu.run(parts.asked(), parts.queries, found, groups);
        ASSERT_EQ(gpu.fault(), nullptr) << gpu.fault();
        for (std::size_t i = 0; i < posed.size(); ++i) {
            ASSERT_EQ(wanted[i].status, found[i].status) << "batch " << batch << ", query " << i;
            ASSERT_EQ(wanted[i].proof, found[i].proof) << "batch " << batch << ", query " << i;
            far += found[i].proof == Proof::far ? 1 : 0;
            near += found[i].status == QueryStatus::ok && found[i].proof != Proof::far ? 1 : 0;
            lost += found[i].status != QueryStatus::ok ? 1 : 0;
        }
        for (std::uint32_t g = 0; !is_short && parts.counts_alike() && g < kGroups; ++g) {
            ASSERT_EQ(wanted_groups[g].used, groups[g].used)
                << "batch " << batch << ", group " << g;
        }
        most_trees = std::max<std::uint64_t>(most_trees, parts.trees.size());
    }
    std::printf("%u batches, up to %llu trees: %llu far, %llu not, %llu lost with their group\n",
                count, static_cast<unsigned long long>(most_trees),
                static_cast<unsigned long long>(far), static_cast<unsigned long long>(near),
                static_cast<unsigned long long>(lost));
    EXPECT_GT(far, 0U);
    EXPECT_GT(near, 0U);
    EXPECT_GT(lost, 0U);
}

// Its first batches are about the first mesh against itself: a few triangles that touch fit into
// every list, and are tested to the end.
TEST(CudaPosedParts, AnEngineOverATetrahedronWarmsUp) {
    AXG_CUDA_ENGINE_OR_SKIP(gpu, {known_answer_mesh()}, test::ample(), CudaOptions{});
    EXPECT_EQ(gpu.fault(), nullptr);
}

}  // namespace
}  // namespace axg
