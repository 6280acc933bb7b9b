// SPDX-License-Identifier: Apache-2.0
// Directions as a proof: those found prove it, others do not, and nothing proves what is nearer.
#include "hil_replay/certify/witness_walk.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace axg {
namespace {

/// A square plate of n x n x 2 triangles, 10 mm wide, at this height.
std::vector<Triangle> plate_of(int n, float z) {
    std::vector<Triangle> out;
    const float step = 10.0F / static_cast<float>(n);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const float x = static_cast<float>(i) * step, y = static_cast<float>(j) * step;
            out.push_back({{x, y, z}, {x + step, y, z}, {x, y + step, z}});
            out.push_back({{x + step, y, z}, {x + step, y + step, z}, {x, y + step, z}});
        }
    }
    return out;
}

struct Raised {
    explicit Raised(const std::vector<Triangle>& triangles)
        : data(build_tree(triangles)), tree{data.nodes, data.leaves, 10} {}
    TreeData data;
    Tree tree;
};

TEST(WitnessWalk, FindsOneDirectionBetweenPlates) {
    const Raised low(plate_of(20, 0)), high(plate_of(20, 2));
    const PlacedSurfaces at{&low.tree, &high.tree, {}};
    WitnessWalk walk;
    Directions directions;
    ASSERT_TRUE(walk.complete(at, 1.999, directions));
    ASSERT_EQ(directions.size(), 1U);
    EXPECT_NEAR(directions[0].z, 1, 1e-6);
    EXPECT_TRUE(walk.proves(at, 1.999, directions));
    EXPECT_FALSE(walk.proves(at, 2.001, directions));
    Directions none;
    EXPECT_FALSE(walk.complete(at, 2.001, none));
}

TEST(WitnessWalk, AWrongDirectionProvesNothing) {
    const Raised low(plate_of(4, 0)), high(plate_of(4, 2));
    const PlacedSurfaces at{&low.tree, &high.tree, {}};
    WitnessWalk walk;
    for (const Vec3f& d : {Vec3f{0, 0, -1}, Vec3f{1, 0, 0}, Vec3f{0, 0, 0}, Vec3f{1, 1, 1}}) {
        EXPECT_FALSE(walk.proves(at, 1, {d}));
    }
    EXPECT_FALSE(walk.proves(at, 1, {}));
    EXPECT_TRUE(walk.proves(at, 1, {{1, 0, 0}, {0, 0, 5}}));  // any length
}

// A plate in an L of two others: no direction alone separates all.
TEST(WitnessWalk, AHollowNeedsSeveralDirections) {
    std::vector<Triangle> corner = plate_of(3, 0);
    for (Triangle t : plate_of(3, 0)) {
        for (Vec3f* p : {&t.a, &t.b, &t.c}) {
            *p = {p->z, p->y, p->x};
        }
        corner.push_back(t);
    }
    const Raised hollow(corner), plate(plate_of(3, 0));
    Pose pose;
    const double slope = std::sqrt(0.5);
    pose.r[0][0] = pose.r[2][2] = slope;
    pose.r[0][2] = -slope;
    pose.r[2][0] = slope;  // from low x and z to high ones
    pose.t[0] = pose.t[2] = 2;
    const PlacedSurfaces at{&plate.tree, &hollow.tree, pose};
    WitnessWalk walk;
    Directions directions;
    ASSERT_TRUE(walk.complete(at, 1, directions));
    EXPECT_GE(directions.size(), 2U);
    EXPECT_TRUE(walk.proves(at, 1, directions));
    EXPECT_FALSE(walk.proves(at, 1, {directions[0]}));
}

TEST(WitnessWalk, TurnsWithTheBody) {
    const Raised low(plate_of(2, 0)), high(plate_of(2, 0));
    Pose pose;  // a quarter turn about x: y to z
    pose.r[1][1] = pose.r[2][2] = 0;
    pose.r[1][2] = -1;
    pose.r[2][1] = 1;
    pose.t[1] = -3;
    const PlacedSurfaces at{&low.tree, &high.tree, pose};
    WitnessWalk walk;
    Directions directions;
    ASSERT_TRUE(walk.complete(at, 2.99, directions));
    EXPECT_FALSE(walk.proves(at, 3.01, directions));
}

}  // namespace
}  // namespace axg
