// SPDX-License-Identifier: Apache-2.0
// Corners that are moved once for all their triangles give to the bit what every vertex moved by
// itself gives: the same trees with and without corners, every lane set, every kind of query.
// AXG_COUNT: queries.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "core/collision/lane_kernels.hpp"
#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kPlaces = 1U << 16U;

struct Answer {
    QueryResult result;
    GroupWork work;
    std::vector<TriangleIds> list;
};

/// The usual surfaces, and one whose triangles share no corner.
std::vector<Mesh> surfaces(test::Draw& draw) {
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    Mesh loose = test::lumpy_ball(draw, 6, 40, 0.2);
    for (Triangle& t : loose.triangles) {
        t.a.x += static_cast<float>(draw.between(0, 1));
        t.b.y += static_cast<float>(draw.between(0, 1));
        t.c.z += static_cast<float>(draw.between(0, 1));
    }
    meshes.push_back(std::move(loose));
    return meshes;
}

class LeafCornersTest : public testing::TestWithParam<LaneSet> {
  protected:
    Answer run(std::span<const Tree> trees, Query query) {
        Answer answer;
        answer.list.resize(64);
        query.list = answer.list;
        const bool has_group = query.kind != QueryKind::clearance;
        answer.work.share = {kPlaces, kPlaces, kPlaces, kPlaces, kPlaces};
        const TraversalLists lists{.nodes = nodes,
                                   .keys = keys,
                                   .node_pairs = kPlaces,
                                   .triangle_pairs = 1U << 24U,
                                   .rechecks = kPlaces,
                                   .group = has_group ? &answer.work : nullptr};
        lane_kernels(GetParam())->run(trees, lists, query, answer.result);
        return answer;
    }
    static std::uint64_t hash_of(const Answer& answer) {
        test::Hash hash;
        hash.add(answer.result, answer.list);
        hash.add(answer.work.used.leaf_pairs);
        hash.add(answer.work.used.box_rows);
        return hash.value();
    }

    test::Draw draw{test::printed_seed(20261123)};
    std::vector<Mesh> meshes = surfaces(draw);
    CpuEngine engine = *test::engine_over(meshes, {}, GetParam());
    std::vector<NodePair> nodes = std::vector<NodePair>(kPlaces);
    std::vector<std::uint64_t> keys = std::vector<std::uint64_t>(kNodeWidth * kNodeWidth);
};

INSTANTIATE_TEST_SUITE_P(Lanes, LeafCornersTest, testing::ValuesIn(test::lane_sets()),
                         [](const auto& set) {
                             return set.param == LaneSet::avx512 ? "avx512"
                                    : set.param == LaneSet::avx2 ? "avx2"
                                                                 : "neon";
                         });

TEST_P(LeafCornersTest, ChangeNoBitOfAnyResult) {
    std::vector<Tree> plain(engine.trees().begin(), engine.trees().end());
    std::size_t listed = 0, leaves = 0;
    for (Tree& tree : plain) {
        for (const LeafCorners& corners : tree.corners) {
            ++leaves;
            listed += corners.count == 0 ? 0 : 1;
        }
        tree.corners = {};
    }
    EXPECT_GT(listed, leaves / 2) << "hardly a leaf has its corners listed";
    EXPECT_LT(listed, leaves) << "no leaf has more corners than places";
    const std::uint64_t count = test::count_from_environment(4000);
    std::uint64_t tested = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Query query =
            test::random_query(draw, static_cast<std::uint32_t>(engine.trees().size()));
        const Answer with = run(engine.trees(), query), without = run(plain, query);
        ASSERT_EQ(hash_of(with), hash_of(without)) << "query " << i;
        tested += with.result.triangle_pairs == 0 ? 0 : 1;
    }
    EXPECT_GT(tested, count / 4);
}

}  // namespace
}  // namespace axg
