// SPDX-License-Identifier: Apache-2.0
// The tests' own distance is right, or what is judged by it would be judged wrongly: known figures,
// and the tree against every pair of triangles.
#include "tests/support/surface_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/sincos.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

std::vector<Triangle> cube(float h) {
    const Vec3f v[8] = {{-h, -h, -h}, {h, -h, -h}, {h, h, -h}, {-h, h, -h},
                        {-h, -h, h},  {h, -h, h},  {h, h, h},  {-h, h, h}};
    const int quads[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                             {2, 3, 7, 6}, {1, 2, 6, 5}, {3, 0, 4, 7}};
    std::vector<Triangle> out;
    for (const auto& q : quads) {
        out.push_back({v[q[0]], v[q[1]], v[q[2]]});
        out.push_back({v[q[0]], v[q[2]], v[q[3]]});
    }
    return out;
}

Pose turned_about_z(double angle_rad, Vec3d t) {
    const SinCos sc = sin_cos(angle_rad);
    Pose pose;
    pose.r[0][0] = pose.r[1][1] = sc.cos;
    pose.r[0][1] = -sc.sin;
    pose.r[1][0] = sc.sin;
    pose.t[0] = t.x;
    pose.t[1] = t.y;
    pose.t[2] = t.z;
    return pose;
}

TEST(SurfaceDistance, CubesFaceToFaceEdgeToFaceAndCornerToCorner) {
    const DistanceTree a{cube(1)};
    const DistanceTree b{cube(1)};
    EXPECT_NEAR(surface_distance(a, b, turned_about_z(0, {5, 0.3, 0}), 100), 3, 1e-12);
    EXPECT_NEAR(surface_distance(a, b, turned_about_z(kPi / 4, {5, 0, 0}), 100), 4 - std::sqrt(2.0),
                1e-12);
    EXPECT_NEAR(surface_distance(a, b, turned_about_z(0, {4, 5, 6}), 100), std::sqrt(29.0), 1e-12);
}

TEST(SurfaceDistance, CrossingSurfacesAreAtZeroAndNestedOnesAreNot) {
    const DistanceTree a{cube(1)};
    const DistanceTree b{cube(3)};
    EXPECT_EQ(surface_distance(a, b, turned_about_z(0.3, {2.5, 0, 0}), 100), 0);
    EXPECT_NEAR(surface_distance(a, b, turned_about_z(0, {0, 0, 0}), 100), 2, 1e-12);
}

TEST(SurfaceDistance, BeyondTheCapIsTheCap) {
    const DistanceTree a{cube(1)};
    EXPECT_EQ(surface_distance(a, a, turned_about_z(0, {5, 0, 0}), 2.5), 2.5);
    EXPECT_LT(surface_distance(a, a, turned_about_z(0, {5, 0, 0}), 3.5), 3.0001);
}

TEST(SurfaceDistance, TheTreeFindsTheNearestOfAllPairs) {
    const std::uint64_t seed = printed_seed(11);
    std::mt19937_64 bits{seed};
    const auto unit = [&bits] { return static_cast<double>(bits() >> 11U) * 0x1p-53; };
    for (int round = 0; round < 20; ++round) {
        std::vector<Triangle> soup[2];
        for (auto& triangles : soup) {
            for (int i = 0; i < 60; ++i) {
                const auto at = [&](double c) { return static_cast<float>(c + unit()); };
                const double x = 8 * unit();
                const double y = 8 * unit();
                const double z = 8 * unit();
                triangles.push_back(
                    {{at(x), at(y), at(z)}, {at(x), at(y), at(z)}, {at(x), at(y), at(z)}});
            }
        }
        const Pose pose = turned_about_z(6 * unit(), {12 * unit(), 4, 9 * unit() - 4});
        const DistanceTree a{soup[0]};
        const DistanceTree b{soup[1]};
        double least = 100;
        for (DistanceTree::Facet p : a.facets) {
            for (Vec3d& v : p.v) {
                v = apply(pose, v);
            }
            for (const DistanceTree::Facet& q : b.facets) {
                least = std::min(least, triangle_distance(p, q));
            }
        }
        EXPECT_EQ(surface_distance(a, b, pose, 100), least) << "round " << round;
    }
}

}  // namespace
}  // namespace axg::test
