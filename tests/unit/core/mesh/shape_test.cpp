// SPDX-License-Identifier: Apache-2.0
// Each shape is a closed shell that contains the true body and stands off by no more than it says,
// wherever it is placed.
#include "core/mesh/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/sincos.hpp"
#include "core/mesh/mesh_check.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

Shape box_of(double x, double y, double z) {
    Shape out;
    out.box_mm = {x, y, z};
    return out;
}

Shape cone_of(double radius, double top, double height, std::uint32_t segments = 48) {
    Shape out;
    out.segments = segments;
    out.profile = cone_profile(radius, top, height);
    return out;
}

Shape sphere_of(double radius, std::uint32_t segments) {
    Shape out;
    out.segments = segments;
    out.profile = sphere_profile(radius, segments);
    return out;
}

/// A quarter turn about x, then 30 degrees about z, and away.
Pose some_place() {
    Pose out;
    const double c = std::sqrt(0.75);
    const double r[3][3] = {{c, 0, 0.5}, {0.5, 0, -c}, {0, 1, 0}};
    std::copy(&r[0][0], &r[0][0] + 9, &out.r[0][0]);
    out.t[0] = 300;
    out.t[1] = -40;
    out.t[2] = 7;
    return out;
}

std::vector<Triangle> built(const Shape& shape) {
    const RevolutionResult out = triangles_of(shape);
    EXPECT_EQ(out.status, RevolutionStatus::ok);
    const MeshReport report = check_mesh(out.triangles);
    EXPECT_TRUE(report.is_closed());
    EXPECT_EQ(report.shells, 1U);
    EXPECT_EQ(report.open_shells + report.inverted_shells + report.self_intersections, 0U);
    EXPECT_EQ(report.degenerate_facets, 0U);
    EXPECT_GT(report.volume_mm3, 0);
    return out.triangles;
}

/// How far p lies before the nearest side of a convex body: at most 0 inside, mm.
double outside(const std::vector<Triangle>& convex, const Vec3d& p) {
    double most = -1e9;
    for (const Triangle& t : convex) {
        const Vec3d a = widen(t.a), n = cross(widen(t.b) - a, widen(t.c) - a);
        most = std::max(most, dot(n, p - a) / std::sqrt(dot(n, n)));
    }
    return most;
}

TEST(Shape, ABoxStandsOnItsOriginWithTheCornersAsStated) {
    const MeshReport report = check_mesh(built(box_of(200, 100, 30)));
    EXPECT_EQ(report.facet_count, 12U);
    EXPECT_EQ(report.min_mm, (Vec3f{-100, -50, 0}));
    EXPECT_EQ(report.max_mm, (Vec3f{100, 50, 30}));
    EXPECT_NEAR(report.volume_mm3, 200 * 100 * 30, 1e-3);
}

TEST(Shape, IsTurnedAndMovedToItsPlace) {
    Shape shape = box_of(20, 10, 4);
    shape.at = some_place();
    for (const double z : {0.001, 3.999}) {
        EXPECT_LT(outside(built(shape), apply(shape.at, {9.99, -4.99, z})), 0);
    }
    EXPECT_GT(outside(built(shape), apply(shape.at, {9.99, -4.99, -0.01})), 0.009);
    EXPECT_GT(outside(built(shape), apply(shape.at, {10.01, 0, 2})), 0.009);
}

TEST(Shape, ConesWithAndWithoutATip) {
    EXPECT_EQ(cone_profile(5, 0, 8).size(), 3U);
    EXPECT_EQ(cone_profile(5, 2, 8).size(), 4U);
    EXPECT_EQ(check_mesh(built(cone_of(5, 0, 8, 16))).facet_count, 2U * 16U);
    EXPECT_EQ(check_mesh(built(cone_of(5, 2, 8, 16))).facet_count, 4U * 16U);
}

struct Round {
    Shape shape;
    double bottom, top;          // z
    double (*radius)(double z);  // of the true body
};

std::vector<Round> rounds() {
    return {{cone_of(20, 20, 50), 0, 50, [](double) { return 20.0; }},
            {cone_of(20, 5, 30, 8), 0, 30, [](double z) { return 20 - 0.5 * z; }},
            {cone_of(3, 0, 6, 17), 0, 6, [](double z) { return 3 - 0.5 * z; }},
            {sphere_of(6, 48), -6, 6, [](double z) { return std::sqrt(36 - z * z); }},
            {sphere_of(6, 8), -6, 6, [](double z) { return std::sqrt(36 - z * z); }},
            {sphere_of(6, 9), -6, 6, [](double z) { return std::sqrt(36 - z * z); }}};
}

// Points of the true surface are inside, to the rounding of the corners.
TEST(Shape, ARoundOneContainsTheTrueBody) {
    std::mt19937_64 random(test::printed_seed(31));
    std::uniform_real_distribution<double> unit(0, 1);
    for (Round& round : rounds()) {
        for (const bool is_moved : {false, true}) {
            round.shape.at = is_moved ? some_place() : Pose{};
            const auto triangles = built(round.shape);
            const double rounding_mm = is_moved ? 350 * 0x1p-22 : 1e-9;
            for (int i = 0; i < 2000; ++i) {
                const double z = round.bottom + (round.top - round.bottom) * unit(random);
                const SinCos turn = sin_cos(2 * kPi * unit(random));
                const double r = round.radius(z);
                const Vec3d p = apply(round.shape.at, {r * turn.cos, r * turn.sin, z});
                ASSERT_LE(outside(triangles, p), rounding_mm) << p.x << ' ' << p.y << ' ' << p.z;
            }
        }
    }
}

TEST(Shape, ARoundOneStandsOffByNoMoreThanItSays) {
    for (const Round& round : rounds()) {
        const double c = sin_cos(kPi / round.shape.segments).cos;
        const bool is_sphere = round.bottom < 0;
        const double share = is_sphere ? 1 / (c * c) - 1 + 6e-6 : 1 / c - 1 + 2e-6;
        double farthest = 0, radius = 0;
        for (const Triangle& t : built(round.shape)) {
            const Vec3d p = widen(t.a);
            const double r = std::hypot(p.x, p.y);
            radius = std::max(radius, round.radius(0));
            farthest =
                std::max(farthest, is_sphere ? std::hypot(r, p.z) - 6 : r - round.radius(p.z));
        }
        EXPECT_LE(farthest, radius * share);
        EXPECT_GE(farthest, 0.4 * radius * share) << "the bound is not merely large";
    }
}

TEST(Shape, WhatCannotBeTurnedIsSaid) {
    EXPECT_EQ(triangles_of(cone_of(5, 5, 5, 7)).status, RevolutionStatus::bad_segments);
    EXPECT_EQ(triangles_of(cone_of(std::nan(""), 5, 5)).status, RevolutionStatus::bad_point);
    EXPECT_EQ(triangles_of(cone_of(-5, 5, 5)).status, RevolutionStatus::bad_point);
}

}  // namespace
}  // namespace axg
