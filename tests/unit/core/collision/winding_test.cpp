// SPDX-License-Identifier: Apache-2.0
// Winding numbers where the result is known by construction: rays through corners, along edges and
// in the planes of facets, cavities, shells in shells, points a billionth of a mm from a facet, and
// each way to get no result.
#include "core/collision/winding.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/support/containment_fixture.hpp"
#include "tests/support/round_solids.hpp"

namespace axg {
namespace {

using test::box;
using test::SolidBody;
using test::together;
using test::turned_over;

/// Eight facets, corners on the axes: every ray along an axis from the centre meets a corner.
test::Triangles octahedron(float r) {
    const Vec3f e{r, 0, 0}, w{-r, 0, 0}, n{0, r, 0}, s{0, -r, 0}, u{0, 0, r}, d{0, 0, -r};
    return {{e, n, u}, {n, w, u}, {w, s, u}, {s, e, u}, {n, e, d}, {w, n, d}, {s, w, d}, {e, s, d}};
}

TEST(Winding, OneInsideACubeAndZeroAroundIt) {
    const SolidBody cube(box({0, 0, 0}, {8, 8, 8}));
    EXPECT_EQ(cube.at({4, 4, 4}), 1);
    EXPECT_EQ(cube.at({1, 2, 3}), 1);
    // Near each side in turn, so that each of the six rays is taken.
    for (int axis = 0; axis < 3; ++axis) {
        for (const double near : {0.5, 7.5}) {
            std::array<double, 3> p{4, 4, 4};
            p[static_cast<std::size_t>(axis)] = near;
            EXPECT_EQ(cube.at({p[0], p[1], p[2]}), 1) << axis << ' ' << near;
            p[static_cast<std::size_t>(axis)] = near < 4 ? -0.5 : 8.5;
            EXPECT_EQ(cube.at({p[0], p[1], p[2]}), 0) << axis << ' ' << near;
        }
    }
}

TEST(Winding, ARayThroughACornerCountsOnce) {
    const SolidBody body(octahedron(8));
    EXPECT_EQ(body.at({0, 0, 0}), 1);
    for (const double x : {-7.0, -0.25, 0.25, 7.0}) {
        EXPECT_EQ(body.at({x, 0, 0}), 1);  // the ray meets a corner, the planes of edges beside it
        EXPECT_EQ(body.at({0, x, 0}), 1);
        EXPECT_EQ(body.at({0, 0, x}), 1);
    }
    for (const double x : {-8.5, 8.5}) {
        EXPECT_EQ(body.at({x, 0, 0}), 0);
    }
}

// From outside, a corner, an edge or two facets in the ray's own plane are grazed, and count
// nothing.
TEST(Winding, AGrazingRayCountsNothing) {
    const auto beside = together(octahedron(8), test::moved(octahedron(8), {64, 0, 0}));
    const SolidBody body(beside);
    for (const double z : {8.0, -8.0}) {
        EXPECT_EQ(body.at({16, 0, z}), 0);  // level with a corner
    }
    EXPECT_EQ(body.at({8.5, 0, 0}), 0);  // in the plane of four edges, a ray away from both bodies
    EXPECT_EQ(body.at({32, 0, 0}), 0);
    const SolidBody boxes(together(box({0, 0, 0}, {8, 8, 8}), box({32, 0, 0}, {40, 8, 8})));
    for (const double y : {0.0, 4.0, 8.0}) {
        for (const double z : {0.0, 4.0, 8.0}) {
            EXPECT_EQ(boxes.at({16, y, z}), 0) << y << ' ' << z;  // in sides, along edges
        }
    }
}

TEST(Winding, ShellsAddUp) {
    const auto outer = box({-16, -16, -16}, {16, 16, 16});
    const auto hollow = together(outer, turned_over(box({-8, -8, -8}, {8, 8, 8})));
    const SolidBody body(hollow);
    EXPECT_EQ(body.at({12, 0, 0}), 1);
    EXPECT_EQ(body.at({0, 0, 0}), 0);
    EXPECT_EQ(body.at({20, 0, 0}), 0);
    const SolidBody kernel(together(hollow, box({-4, -4, -4}, {4, 4, 4})));
    EXPECT_EQ(kernel.at({0, 0, 0}), 1);
    EXPECT_EQ(kernel.at({6, 0, 0}), 0);
    EXPECT_EQ(kernel.at({12, 0, 0}), 1);
    const SolidBody twice(together(outer, box({-8, -8, -8}, {8, 8, 8})));
    EXPECT_EQ(twice.at({0, 0, 0}), 2);
    EXPECT_EQ(SolidBody(turned_over(outer)).at({0, 0, 0}), -1);
}

TEST(Winding, ARingHasAHole) {
    const SolidBody body(test::ring(48, 24, 40, 10));
    EXPECT_EQ(body.at({0, 0, 0}), 0);
    EXPECT_EQ(body.at({40, 0, 0}), 1);
    EXPECT_EQ(body.at({0, -40, 0}), 1);
    EXPECT_EQ(body.at({28, 0, 0}), 0);
}

TEST(Winding, WhatIsOpenBoundsNothing) {
    auto open = box({0, 0, 0}, {8, 8, 8});
    open.pop_back();
    EXPECT_EQ(SolidBody(open).at({4, 4, 4}), 0);
    const SolidBody both(together(open, box({-16, -16, -16}, {16, 16, 16})));
    EXPECT_EQ(both.at({4, 4, 4}), 1) << "the closed shell around it still counts";
    EXPECT_EQ(both.at({12, 12, 12}), 1);
}

TEST(Winding, FacetsWithoutAreaChangeNothing) {
    auto body = box({0, 0, 0}, {8, 8, 8});
    body.push_back({{4, 4, 6}, {4, 4, 6}, {2, 4, 6}});  // on the ray, and in its plane
    body.push_back({{4, 4, 7}, {4, 4, 7}, {4, 4, 7}});
    // One side's edge is cut in two, its neighbour's is not: a facet that is only a line closes it.
    const Triangle cut = body[2];
    const Vec3f middle = 0.5F * (cut.a + cut.b);
    body[2] = {cut.a, middle, cut.c};
    body.push_back({middle, cut.b, cut.c});
    EXPECT_EQ(SolidBody(body).at({4, 4, 5}), 0) << "open as it is";
    body.push_back({cut.a, cut.b, middle});
    const SolidBody solid(body);
    EXPECT_EQ(solid.at({4, 4, 5}), 1);
    EXPECT_EQ(solid.at({4, 4, 9}), 0);
}

// A slanted facet through three corners of the grid: one step of the point grid decides.
TEST(Winding, OneStepFromAFacetIsToldExactly) {
    const SolidBody body(octahedron(8));
    for (const double scale : {1.0, 0.125}) {
        const Vec3d on{4 * scale, 3 * scale, 8 - 7 * scale};  // x + y + z = 8
        EXPECT_EQ(body.at({on.x, on.y, on.z - kPointGridMm}), 1);
        EXPECT_EQ(body.at({on.x, on.y, on.z + kPointGridMm}), 0);
        EXPECT_EQ(body.at({on.x - kPointGridMm, on.y, on.z}), 1);
        EXPECT_EQ(body.at({on.x, on.y + kPointGridMm, on.z}), 0);
    }
}

TEST(Winding, APointOnAFacetIsNotJudged) {
    const SolidBody body(octahedron(8));
    RayWork work;
    const Winding out = body.wound({1, 1, 6}, work);
    EXPECT_FALSE(out.is_known);
    EXPECT_EQ(work.status, QueryStatus::ok) << "no capacity was short";
}

// What a CAD program writes for a zero: numbers of 1e-15 and less beside whole ones, down to the
// least float.
TEST(Winding, NoiseForZerosIsTakenAsItIs) {
    for (const float noise : {1e-15F, 1e-30F, 0x1p-149F}) {
        test::Triangles cube = box({0, 0, 0}, {8, 8, 8});
        for (Triangle& t : cube) {
            for (Vec3f* corner : {&t.a, &t.b, &t.c}) {
                corner->x = corner->x == 0 ? -noise : corner->x;
                corner->y = corner->y == 0 ? -2 * noise : corner->y;
            }
        }
        const SolidBody body(test::moved(cube, {0, 0, 0}));
        for (const double y : {0.0, 4.0}) {
            EXPECT_EQ(body.at({0, y, 4}), 1) << noise;
            EXPECT_EQ(body.at({-kPointGridMm, y, 4}), 0) << noise;
        }
    }
}

TEST(Winding, LargeAndFarBodiesAreBodiesTo) {
    const SolidBody large(box({-1e5F, -1e5F, -1e5F}, {1e5F, 1e5F, 1e5F}));
    EXPECT_EQ(large.at({99999, -99999, 99999}), 1);
    EXPECT_EQ(large.at({100001, 0, 0}), 0);
    const SolidBody far(test::moved(octahedron(0.5), {99999, 99999, -99999}));
    EXPECT_EQ(far.at({99999, 99999, -99999}), 1);
    EXPECT_EQ(far.at({99999, 99999, -99998}), 0);
}

TEST(Winding, EachCapacityHasAnEnd) {
    const SolidBody body(test::ball(12, 40));
    const Vec3d centre{0, 0, 0};  // an edge and a corner on every ray
    RayWork used;
    ASSERT_TRUE(body.wound(centre, used).is_known);
    ASSERT_GT(used.nodes, 1U);
    ASSERT_GT(used.triangles, 0U);
    ASSERT_GT(used.exact_signs, 0U);
    const auto judged = [&](Capacities capacities) {
        RayWork work;
        const Winding out = body.wound(centre, work, capacities);
        EXPECT_EQ(out.is_known, work.status == QueryStatus::ok);
        return work.status;
    };
    const Capacities enough{used.nodes, used.triangles, used.exact_signs};
    EXPECT_EQ(judged(enough), QueryStatus::ok);
    Capacities less = enough;
    --less.node_pairs;
    EXPECT_EQ(judged(less), QueryStatus::too_many_node_pairs);
    less = enough;
    --less.triangle_pairs;
    EXPECT_EQ(judged(less), QueryStatus::too_many_triangle_pairs);
    less = enough;
    --less.rechecks;
    EXPECT_EQ(judged(less), QueryStatus::too_many_rechecks);
}

TEST(Winding, SeveralRaysShareOneAccount) {
    const SolidBody body(test::ball(12, 40));
    RayWork once, twice;
    (void)body.wound({1, 2, 3}, once);
    (void)body.wound({1, 2, 3}, twice);
    (void)body.wound({1, 2, 3}, twice);
    EXPECT_EQ(twice.nodes, 2 * once.nodes);
    EXPECT_EQ(twice.triangles, 2 * once.triangles);
}

TEST(Winding, ThePointGridKeepsWhatIsOnItAndRoundsTheRest) {
    for (const double x : {0.0, 1.0, -3.5, 131071.0, kPointGridMm, -kPointGridMm}) {
        const Vec3d p = on_point_grid({x, -x, x});
        EXPECT_EQ(p, (Vec3d{x, -x, x}));
    }
    for (const double x : {1.0 / 3, -70000.1, 1e-300}) {
        const Vec3d p = on_point_grid({x, 0, 0});
        EXPECT_LE(std::fabs(p.x - x), kPointGridMm / 2);
        EXPECT_EQ(std::fmod(p.x, kPointGridMm), 0);
    }
}

}  // namespace
}  // namespace axg
