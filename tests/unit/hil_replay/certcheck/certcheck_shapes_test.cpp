// SPDX-License-Identifier: Apache-2.0
// Box trees, the walk with given directions and the winding numbers, on boxes whose answers are
// plain.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "hil_replay/certcheck/enclosure.hpp"
#include "hil_replay/certcheck/separation.hpp"

namespace axg::certcheck {
namespace {

using Corner = std::array<float, 3>;

/// A closed box, seen from outside or from inside.
std::vector<Triangle> box(Corner low, Corner high, bool inwards = false) {
    const std::array<std::array<unsigned, 4>, 6> quads{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    std::vector<Triangle> triangles;
    for (auto quad : quads) {
        if (inwards) {
            std::ranges::reverse(quad);
        }
        for (const auto& three : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
            Triangle triangle;
            for (unsigned i = 0; i < 9; ++i) {
                const unsigned corner = quad[static_cast<unsigned>(three[i / 3])];
                triangle[i] = (corner >> (i % 3) & 1U) != 0 ? high[i % 3] : low[i % 3];
            }
            triangles.push_back(triangle);
        }
    }
    return triangles;
}

std::vector<Triangle> both(std::vector<Triangle> a, const std::vector<Triangle>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Pose shifted(double x, double y = 0, double z = 0) {
    Pose pose;
    pose.shift = {{x, y, z}};
    return pose;
}

TEST(CertcheckTree, EachNodeHoldsItsChildrenAndEachTriangleHasOneLeaf) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number(-9, 9);
    for (std::size_t count = 1; count < 70; ++count) {
        std::vector<Triangle> triangles(count);
        for (Triangle& triangle : triangles) {
            std::ranges::generate(triangle, [&] { return number(random); });
        }
        const BoxTree tree(triangles);
        std::vector<Triangle> leaves;
        std::vector<TreeNode> open{tree.top()};
        while (!open.empty()) {
            const TreeNode node = open.back();
            open.pop_back();
            for (std::uint32_t i = 0; i < 9 * node.count; ++i) {
                const float value = tree.triangles()[node.first + i / 9][i % 9];
                EXPECT_TRUE(tree.box(node)[i % 3].low <= value &&
                            value <= tree.box(node)[i % 3].high);
            }
            if (node.count == 1) {
                leaves.push_back(tree.triangle(node));
                continue;
            }
            EXPECT_EQ(node.lower().count + node.upper().count, node.count);
            open.push_back(node.lower());
            open.push_back(node.upper());
        }
        std::ranges::sort(leaves);
        std::ranges::sort(triangles);
        EXPECT_EQ(leaves, triangles);
    }
}

TEST(CertcheckSeparation, HoldsUpToTheGapAndNoFurther) {
    const BoxTree a(box({-1, -1, -1}, {1, 1, 1}));
    const Pose at = shifted(0);
    const Pose away = shifted(12);
    const auto refused = [&](const std::vector<Direction>& directions, double r) {
        return !not_separated({a, at}, {a, away}, directions, r).empty();
    };
    EXPECT_FALSE(refused({{1, 0, 0}}, 9.999999));
    EXPECT_TRUE(refused({{1, 0, 0}}, 10));
    EXPECT_TRUE(refused({{1, 0, 0}}, 10.000001));
    EXPECT_FALSE(refused({{5e8F, 0, 0}}, 9.999999));
    EXPECT_FALSE(refused({{1e-8F, 0, 0}}, 9.999999));
    EXPECT_TRUE(refused({{-1, 0, 0}}, 0));  // a gap of -14, whose square is large (A17)
    EXPECT_TRUE(refused({{-1, 0, 0}}, 1));
    EXPECT_TRUE(refused({{0, 0, 0}}, 0));
    EXPECT_TRUE(refused({{0, 1, 0}}, 0));
    EXPECT_TRUE(refused({}, 0));
    EXPECT_FALSE(refused({{0, 1, 0}, {0, 0, 0}, {1, 0, 0}}, 9));
}

// No direction separates all of an L from a block in its corner; two do, part by part.
TEST(CertcheckSeparation, TakesAnyDirectionForEachPairOfTriangles) {
    const BoxTree corner(both(box({3, -9, -9}, {4, 9, 9}), box({-9, 3, -9}, {9, 4, 9})));
    const BoxTree block(box({-1, -1, -1}, {1, 1, 1}));
    const Pose at = shifted(0);
    EXPECT_EQ(not_separated({block, at}, {corner, at}, {{1, 0, 0}, {0, 1, 0}}, 1.9), "");
    EXPECT_NE(not_separated({block, at}, {corner, at}, {{1, 0, 0}}, 1.9), "");
    EXPECT_NE(not_separated({block, at}, {corner, at}, {{1, 0, 0}, {0, 1, 0}}, 2.1), "");
}

TEST(CertcheckEnclosure, PartsAreConnectedAndClosedOrOpen) {
    const auto one = box({0, 0, 0}, {1, 1, 1});
    auto open = box({5, 0, 0}, {6, 1, 1});
    open.pop_back();
    const Parts parts = parts_of(both(both(one, open), box({1, 1, 1}, {2, 2, 2})));
    EXPECT_EQ(parts.corners.size(), 2U);  // the first and the last share a corner
    EXPECT_EQ(parts.open_count, 1U);
    EXPECT_EQ(parts.closed.triangles().size(), 24U);
}

TEST(CertcheckEnclosure, FindsAPartInsideWhateverItsPlace) {
    const Parts small = parts_of(box({-1, -1, -1}, {1, 1, 1}));
    const Parts large = parts_of(box({-50, -50, -50}, {50, 50, 50}));
    std::mt19937 random(2);
    std::uniform_real_distribution<double> number(-90, 90);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
        const double x = number(random), y = number(random), z = number(random);
        const double most = std::max({std::fabs(x - 1), std::fabs(y - 1), std::fabs(z - 1)});
        // The corner that is looked at is one of the block's; 48 and 52: surely in or out.
        const bool is_in = std::max({std::fabs(x), std::fabs(y), std::fabs(z)}) < 48;
        const bool is_out = std::max({std::fabs(x), std::fabs(y), std::fabs(z)}) > 52 && most > 52;
        const bool outside = is_outside(small, shifted(x, y, z), large, Pose{});
        EXPECT_TRUE(!is_in || !outside) << x << " " << y << " " << z;
        EXPECT_TRUE(!is_out || outside) << x << " " << y << " " << z;
        inside += is_in;
    }
    EXPECT_GT(inside, 2000);
}

TEST(CertcheckEnclosure, ACavityIsOutsideAndAnOpenPartHoldsNothing) {
    const Parts block = parts_of(box({-1, -1, -1}, {1, 1, 1}));
    const auto shell = box({-50, -50, -50}, {50, 50, 50});
    const Parts hollow = parts_of(both(shell, box({-40, -40, -40}, {40, 40, 40}, true)));
    EXPECT_TRUE(is_outside(block, Pose{}, hollow, Pose{}));
    EXPECT_FALSE(is_outside(block, shifted(45), hollow, Pose{}));
    EXPECT_TRUE(is_outside(block, shifted(60), hollow, Pose{}));
    auto open = shell;
    open.pop_back();
    EXPECT_TRUE(is_outside(block, Pose{}, parts_of(open), Pose{}));
    // Turned inside out it winds the other way, and still holds what is inside.
    EXPECT_FALSE(
        is_outside(block, Pose{}, parts_of(box({-50, -50, -50}, {50, 50, 50}, true)), Pose{}));
}

TEST(CertcheckEnclosure, APointOnTheSurfaceIsNotSurelyOutside) {
    const Parts shell = parts_of(box({-50, -50, -50}, {50, 50, 50}));
    const auto outside = [&](Vector point) {
        Parts one;
        one.corners.push_back(point);
        return is_outside(one, Pose{}, shell, Pose{});
    };
    EXPECT_FALSE(outside({{50, 3, 4}}));     // a face
    EXPECT_FALSE(outside({{-50, 7, 7}}));    // its diagonal
    EXPECT_FALSE(outside({{50, -50, 4}}));   // an edge
    EXPECT_FALSE(outside({{50, 50, -50}}));  // a corner
    EXPECT_FALSE(outside({{49.999, 3, 4}}));
    EXPECT_TRUE(outside({{50.001, 3, 4}}));
}

}  // namespace
}  // namespace axg::certcheck
