// SPDX-License-Identifier: Apache-2.0
// The tree holds every triangle once, its boxes hold their triangles in exact arithmetic, and no
// input makes it deeper than the bound. Method: traverse the finished tree and count.
#include "core/collision/tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random_queries.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

/// |v - c| <= h in exact arithmetic: the difference in double and what it lost (Knuth's two-sum).
bool holds(float c, float h, float v) {
    const double x = v, y = -static_cast<double>(c);
    const double sum = x + y, part = sum - x;
    const double lost = (x - (sum - part)) + (y - part);
    const double size = std::fabs(sum), more = sum < 0 ? -lost : lost;
    return size < h || (size == h && more <= 0);
}

struct Count {
    std::vector<int> seen;
    std::uint32_t depth = 0, leaves = 0;
};

void expect_inside(const float (&c)[3], const float (&h)[3], const Triangle& t) {
    for (const Vec3f& v : {t.a, t.b, t.c}) {
        const float p[3] = {v.x, v.y, v.z};
        for (int k = 0; k < 3; ++k) {
            ASSERT_TRUE(holds(c[k], h[k], p[k])) << c[k] << " +- " << h[k] << ": " << p[k];
        }
    }
}

/// Triangles below a node, all of them inside `box`.
void count_below(const TreeData& tree, const std::vector<Triangle>& triangles, std::uint32_t index,
                 const Aabb& box, std::uint32_t depth, Count& count) {
    ASSERT_LT(index, tree.nodes.size());
    const TreeNode& node = tree.nodes[index];
    count.depth = std::max(count.depth, depth);
    ASSERT_GE(node.count, 1U);
    ASSERT_LE(node.count, kNodeWidth);
    for (std::uint32_t i = 0; i < node.count; ++i) {
        Aabb child{};
        for (int k = 0; k < 3; ++k) {
            child.c[k] = node.c[k][i];
            child.h[k] = node.h[k][i];
        }
        if (node.leaf == kNoLeaf) {
            count_below(tree, triangles, node.first_child + i, child, depth + 1, count);
            continue;
        }
        const TreeLeaf& leaf = tree.leaves[node.leaf];
        const Triangle& t = triangles.at(leaf.triangle[i]);
        ++count.seen.at(leaf.triangle[i]);
        for (const Aabb& outer : {box, node.box, child}) {
            expect_inside(outer.c, outer.h, t);
        }
        const float v[9] = {t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z};
        for (int k = 0; k < 9; ++k) {
            ASSERT_EQ(leaf.v[k][i], v[k]);
        }
    }
    count.leaves += node.leaf == kNoLeaf ? 0 : 1;
    for (std::uint32_t i = node.count; i < kNodeWidth; ++i) {  // padding: apart from everything
        ASSERT_GT(node.c[0][i], 4 * kCoordinateMmMax);
        if (node.leaf != kNoLeaf) {
            ASSERT_LT(tree.leaves[node.leaf].triangle[i], triangles.size());
        }
    }
}

void expect_whole(const std::vector<Triangle>& triangles, const TreeData& tree) {
    Count count;
    count.seen.resize(triangles.size());
    count_below(tree, triangles, 0, tree.nodes.at(0).box, 1, count);
    for (const int times : count.seen) {
        ASSERT_EQ(times, 1);
    }
    EXPECT_EQ(count.leaves, tree.leaves.size());
    EXPECT_EQ(count.depth, tree.depth);
    EXPECT_LE(count.depth, kTreeDepthMax);
}

void expect_whole(const std::vector<Triangle>& triangles) {
    expect_whole(triangles, build_tree(triangles));
}

std::vector<Triangle> random_triangles(std::uint64_t seed, std::uint32_t count) {
    test::Draw draw(seed);
    std::vector<Triangle> out(count);
    const auto near = [&draw](Vec3f at, double by) {
        return Vec3f{at.x + static_cast<float>(draw.between(-by, by)),
                     at.y + static_cast<float>(draw.between(-by, by)),
                     at.z + static_cast<float>(draw.between(-by, by))};
    };
    for (Triangle& t : out) {
        const Vec3f at = near({0.1F, 1e4F, -333.3F}, 500);
        t = {near(at, 7), near(at, 7), near(at, 7)};
    }
    return out;
}

TEST(Tree, HoldsEveryTriangleOnceAtEverySizeAroundALeafAndALevel) {
    const std::uint64_t seed = test::printed_seed(11);
    for (const std::uint32_t count : {1U, 2U, 31U, 32U, 33U, 64U, 1023U, 1024U, 1025U, 5000U}) {
        SCOPED_TRACE(count);
        expect_whole(random_triangles(seed + count, count));
    }
}

TEST(Tree, IsOneLeafUpTo32TrianglesAndNotBeyond) {
    EXPECT_EQ(build_tree(random_triangles(1, 32)).nodes.size(), 1U);
    EXPECT_EQ(build_tree(random_triangles(1, 32)).leaves.size(), 1U);
    EXPECT_GT(build_tree(random_triangles(1, 33)).leaves.size(), 1U);
    EXPECT_EQ(build_tree(random_triangles(1, 33)).nodes[0].leaf, kNoLeaf);
}

TEST(Tree, StaysShallowWhenAllTrianglesAreTheSame) {
    const Triangle t{{1, 2, 3}, {4, 5, 6}, {7, 8, 1}};
    for (const std::size_t count : {33U, 1024U, 1025U, 20000U}) {
        SCOPED_TRACE(count);
        expect_whole(std::vector<Triangle>(count, t));
    }
}

TEST(Tree, StaysShallowOverPointsWithoutAnyArea) {
    std::vector<Triangle> points;  // facets of one point each: every cut costs 0
    for (int i = 0; i < 5000; ++i) {
        const Vec3f p{static_cast<float>(i % 7), 0, 0};
        points.push_back({p, p, p});
    }
    expect_whole(points);
}

TEST(Tree, StaysShallowOverAGeometricChain) {
    // Each triangle a fixed share of the one before: the surface area heuristic would cut off one
    // at a time.
    for (const double share : {0.5, 0.9, 0.999}) {
        SCOPED_TRACE(share);
        std::vector<Triangle> chain;
        double size = 9e4;
        for (int i = 0; i < 20000; ++i) {
            const auto s = static_cast<float>(size);
            chain.push_back({{s, 0, 0}, {0.9F * s, 0.05F * s, 0}, {0.9F * s, 0, 0.05F * s}});
            size *= share;
        }
        expect_whole(chain);
    }
}

TEST(Tree, IsTheSameTreeEveryTime) {
    const std::vector<Triangle> triangles = random_triangles(5, 700);
    const TreeData one = build_tree(triangles), two = build_tree(triangles);
    ASSERT_EQ(one.leaves.size(), two.leaves.size());
    for (std::size_t i = 0; i < one.leaves.size(); ++i) {
        for (std::uint32_t k = 0; k < kNodeWidth; ++k) {
            ASSERT_EQ(one.leaves[i].triangle[k], two.leaves[i].triangle[k]);
        }
    }
}

/// Any grouping at all: triangles in any order, leaves and parents of any size.
void add_random_node(test::Draw& draw, std::uint32_t tree_level, TreeShape& shape,
                     std::uint32_t& held) {
    const auto one_to = [&draw](double most) {
        return static_cast<std::uint32_t>(draw.between(1, most + 0.999));
    };
    if (tree_level == kTreeDepthMax || draw.between(0, 1) < 0.4) {
        const std::uint32_t count = one_to(kNodeWidth);
        shape.nodes.push_back(static_cast<std::uint8_t>(kLeafMark | count));
        held += count;
        return;
    }
    const std::uint32_t count = one_to(tree_level == 1 ? kNodeWidth : 3);
    shape.nodes.push_back(static_cast<std::uint8_t>(count));
    for (std::uint32_t i = 0; i < count; ++i) {
        add_random_node(draw, tree_level + 1, shape, held);
    }
}

// What comes from a file may group its triangles badly, and the tree is right all the same.
TEST(TreeShape, ATreeOfAnySoundGroupingHoldsEveryTriangle) {
    const std::uint64_t seed = test::printed_seed(12);
    for (std::uint64_t i = 0; i < 40; ++i) {
        test::Draw draw(seed + i);
        Mesh mesh;
        std::uint32_t count = 0;
        add_random_node(draw, 1, mesh.shape, count);
        mesh.triangles = random_triangles(seed + i, count);
        for (std::uint32_t k = 0; k < count; ++k) {
            mesh.shape.triangles.push_back((k * 7919U + 13U) % count);
        }
        if (count % 7919 == 0) {
            continue;  // no permutation
        }
        ASSERT_TRUE(is_sound(mesh.shape, count)) << seed + i;
        expect_whole(mesh.triangles, build_tree(mesh));
    }
}

TEST(TreeShape, IsSoundAsItWasFoundAndNotWithAnyOneFault) {
    const std::vector<Triangle> triangles = random_triangles(3, 2000);
    const TreeShape found = group_triangles(triangles);
    ASSERT_TRUE(is_sound(found, 2000));
    EXPECT_FALSE(is_sound(found, 1999));
    EXPECT_FALSE(is_sound(TreeShape{}, 0));
    const auto is_sound_with = [&found](auto&& fault) {
        TreeShape shape = found;
        fault(shape);
        return is_sound(shape, 2000);
    };
    EXPECT_FALSE(is_sound_with([](TreeShape& s) { s.nodes.pop_back(); }));
    EXPECT_FALSE(is_sound_with([](TreeShape& s) { s.nodes.push_back(kLeafMark | 1); }));
    EXPECT_FALSE(is_sound_with([](TreeShape& s) { s.triangles[7] = s.triangles[8]; }));
    EXPECT_FALSE(is_sound_with([](TreeShape& s) { s.triangles[7] = 2000; }));
    EXPECT_FALSE(is_sound_with([](TreeShape& s) { s.triangles.pop_back(); }));
    for (std::size_t i = 0; i < found.nodes.size(); ++i) {
        for (const std::uint32_t other : {0x00U, 0x21U, 0x7FU, 0x80U, 0xA1U, 0xFFU}) {
            EXPECT_FALSE(is_sound_with([=](TreeShape& s) {
                s.nodes[i] = static_cast<std::uint8_t>(other);
            })) << i
                << ": " << other;
        }
        EXPECT_FALSE(is_sound_with([i](TreeShape& s) { ++s.nodes[i]; })) << i;
    }
}

TEST(TreeShape, IsRefusedOneLevelBelowTheDeepest) {
    for (const std::uint32_t depth : {kTreeDepthMax, kTreeDepthMax + 1}) {
        TreeShape chain;
        chain.nodes.assign(depth - 1, 1);
        chain.nodes.push_back(kLeafMark | 1);
        chain.triangles = {0};
        EXPECT_EQ(is_sound(chain, 1), depth == kTreeDepthMax);
    }
}

/// A leaf whose triangles use so many corners: a fan around the first.
TreeLeaf fan(unsigned corners) {
    TreeLeaf leaf{};
    for (unsigned i = 0; i < kNodeWidth; ++i) {
        for (unsigned vertex = 1; vertex < 3; ++vertex) {
            leaf.v[3 * vertex][i] = static_cast<float>(1 + (i + vertex) % (corners - 1));
        }
    }
    return leaf;
}

TEST(LeafCorners, AreTheVerticesOfEveryTriangle) {
    for (const TreeLeaf& leaf : build_tree(random_triangles(5, 1)).leaves) {
        EXPECT_EQ(corners_of(leaf).count, 3U);
    }
    for (const unsigned count : {3U, 8U, 9U, 31U, 32U}) {
        const TreeLeaf leaf = fan(count);
        const LeafCorners corners = corners_of(leaf);
        EXPECT_EQ(corners.count, count);
        for (unsigned i = 0; i < kNodeWidth; ++i) {
            for (unsigned k = 0; k < 9; ++k) {
                EXPECT_EQ(corners.v[k % 3][corners.at[k / 3][i]], leaf.v[k][i]);
            }
        }
    }
}

TEST(LeafCorners, AreNotListedWhereTheyAreMoreThanALeafHasPlaces) {
    EXPECT_EQ(corners_of(fan(33)).count, 0U);
    EXPECT_EQ(corners_of(build_tree(random_triangles(6, 32)).leaves.front()).count, 0U);
}

TEST(LeafCorners, KeepTheSignOfAZero) {
    TreeLeaf leaf = fan(8);
    leaf.v[1][3] = -0.0F;
    const LeafCorners corners = corners_of(leaf);
    EXPECT_EQ(corners.count, 9U);
    EXPECT_TRUE(std::signbit(corners.v[1][corners.at[0][3]]));
    EXPECT_FALSE(std::signbit(corners.v[1][corners.at[0][4]]));
}

}  // namespace
}  // namespace axg
