// SPDX-License-Identifier: Apache-2.0
// ctest-labels: long
// What a cutter sweeps: nothing that turns with it sticks out, told by winding numbers at points of
// the surface turned by any angle; and it is not much larger than that, told by radii.
#include "core/mesh/swept_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/mesh/mesh_check.hpp"
#include "core/mesh/shape.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/solid_angle.hpp"
#include "tests/support/solids.hpp"

namespace {

using namespace axg;
using axg::test::box;
using axg::test::solid_angle_winding;
using axg::test::together;
using axg::test::Triangles;

Vec3d turned_by(const Vec3d& p, double angle) {
    return {p.x * std::cos(angle) - p.y * std::sin(angle),
            p.x * std::sin(angle) + p.y * std::cos(angle), p.z};
}

/// The outline's radius at a height; the larger one at a step.
double radius_at(const std::vector<Vec3d>& profile, double height) {
    double radius = -1;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const Vec3d a = profile[i], b = profile[i + 1];
        if (a.z <= height && height <= b.z) {
            const double t = b.z > a.z ? (height - a.z) / (b.z - a.z) : 0;
            radius = std::max({radius, a.x + t * (b.x - a.x), b.z > a.z ? 0.0 : b.x});
        }
    }
    return radius;
}

Triangles with_corners(std::mt19937_64& random, std::size_t count, double size_mm) {
    std::uniform_real_distribution<double> at(-size_mm, size_mm);
    const auto corner = [&] {
        return Vec3f{static_cast<float>(at(random)), static_cast<float>(at(random)),
                     static_cast<float>(at(random))};
    };
    Triangles out;
    for (std::size_t i = 0; i < count; ++i) {
        out.push_back({corner(), corner(), corner()});
    }
    return out;
}

TEST(SweptProfile, ABoxBecomesTheCylinderAroundIt) {
    const auto profile = swept_profile(box({-3, -4, -10}, {3, 4, 30}));
    ASSERT_EQ(profile.size(), 4U);
    EXPECT_NEAR(profile[1].x, 5, 1e-5);
    EXPECT_NEAR(profile[2].x, 5, 1e-5);
    EXPECT_GE(profile[1].x, 5);
    EXPECT_NEAR(profile[0].z, -10, 1e-5);
    EXPECT_LT(profile[0].z, -10);
    EXPECT_NEAR(profile[3].z, 30, 2e-5);
    EXPECT_GT(profile[3].z, 30);
}

TEST(SweptProfile, AStepStaysAStep) {  // a T-slot cutter: wide below, thin above
    const auto profile =
        swept_profile(together(box({-12, -1, 0}, {12, 1, 5}), box({-3, -3, 5}, {3, 3, 60})));
    EXPECT_NEAR(radius_at(profile, 4.99), std::hypot(12, 1), 0.011);
    EXPECT_NEAR(radius_at(profile, 5.001), std::hypot(3, 3), 0.011);
    EXPECT_NEAR(radius_at(profile, 40), std::hypot(3, 3), 0.011);
}

TEST(SweptProfile, ATiltedEdgeIsNotItsHyperbola) {  // between two corners at 10 mm the edge is at 6
    const Triangles strut = {{{10, 0, 0}, {6, 8, 40}, {10, 0, 1}}};
    const auto profile = swept_profile(strut);
    for (double z = 0; z <= 40; z += 0.25) {
        EXPECT_GE(radius_at(profile, z), std::hypot(10 - 0.1 * z, 0.2 * z));
    }
    EXPECT_NEAR(radius_at(profile, 20), 10, 0.02);
}

TEST(SweptProfile, ALevelSheetHasNoHeightAndIsContained) {
    const Triangles sheet = {{{0, 0, 7}, {30, 0, 7}, {0, 30, 7}}};
    const RevolutionResult result = swept_solid(sheet);
    ASSERT_EQ(result.status, RevolutionStatus::ok);
    EXPECT_NEAR(solid_angle_winding(result.triangles, {29.9, 0, 7}), 1, 1e-3);
    EXPECT_TRUE(check_mesh(result.triangles).is_closed());
}

TEST(SweptProfile, NothingThatTurnsSticksOut) {
    std::mt19937_64 random(axg::test::printed_seed(20));
    std::uniform_real_distribution<double> unit(0, 1);
    for (int round = 0; round < 25; ++round) {
        const Triangles mesh = with_corners(random, 1U + static_cast<unsigned>(round), 20);
        const RevolutionResult result = swept_solid(mesh);
        ASSERT_EQ(result.status, RevolutionStatus::ok) << round;
        const MeshReport report = check_mesh(result.triangles);
        EXPECT_TRUE(report.is_closed());
        EXPECT_GT(report.volume_mm3, 0);
        for (int i = 0; i < 40; ++i) {
            const Triangle& t =
                mesh[static_cast<std::size_t>(unit(random) * static_cast<double>(mesh.size()))];
            const double u = std::sqrt(unit(random)), v = unit(random);
            const bool is_corner = i % 4 == 0;
            const Vec3d p = is_corner ? widen(t.a)
                                      : (1 - u) * widen(t.a) + (u * (1 - v)) * widen(t.b) +
                                            (u * v) * widen(t.c);
            const Vec3d at = turned_by(p, 2 * std::numbers::pi * unit(random));
            EXPECT_NEAR(solid_angle_winding(result.triangles, at), 1, 1e-2)
                << round << ": " << at.x << ' ' << at.y << ' ' << at.z;
        }
    }
}

TEST(SweptProfile, AFineBallGrowsByHundredths) {
    Shape ball;
    ball.profile = sphere_profile(8, 200);
    ball.segments = 200;
    const auto profile = swept_profile(triangles_of(ball).triangles);
    EXPECT_LE(profile.size(), kProfilePointsMax);
    for (double z = -7.99; z < 8; z += 0.01) {
        const double round = std::sqrt(64 - z * z);
        EXPECT_GE(radius_at(profile, z), round);
        EXPECT_LE(radius_at(profile, z), std::sqrt(8.01 * 8.01 - z * z) + 0.011) << z;
    }
}

TEST(SweptProfile, TooManyHeightsAreTakenTogether) {
    std::mt19937_64 random(axg::test::printed_seed(21));
    const Triangles mesh = with_corners(random, 6000, 5);
    const RevolutionResult result = swept_solid(mesh);
    ASSERT_EQ(result.status, RevolutionStatus::ok);
    for (std::size_t i = 0; i < mesh.size(); i += 400) {
        EXPECT_NEAR(solid_angle_winding(result.triangles, widen(mesh[i].b)), 1, 1e-2);
    }
}

TEST(SweptProfile, WhatCannotBeTurnedIsRefused) {
    EXPECT_EQ(swept_solid({}).status, RevolutionStatus::bad_point_count);
    const Triangles far = {{{90000, 90000, 0}, {90000, 90000, 1}, {90000, 90001, 1}}};
    EXPECT_EQ(swept_solid(far).status, RevolutionStatus::bad_point);
}

TEST(SweptProfile, TheCircleIsNeverFartherThanItSays) {
    for (const double radius : {0.5, 6.0, 31.5, 100.0, 250.0}) {
        const double n = swept_segments(radius);
        EXPECT_LE(radius * (1 / std::cos(std::numbers::pi / n) - 1), kSweptCircleMm + 1e-9);
    }
}

TEST(SweptProfile, ASectionBesideTheAxisSweepsARing) {
    Shape insert;
    insert.box_mm = {4, 4, 6};
    insert.at.t[0] = 20;
    EXPECT_EQ(triangles_of(insert).triangles.size(), 12U);
    insert.turns = true;
    const RevolutionResult swept = triangles_of(insert);
    ASSERT_EQ(swept.status, RevolutionStatus::ok);
    EXPECT_NEAR(solid_angle_winding(swept.triangles, {-21.9, 0, 3}), 1, 1e-3);
    EXPECT_NEAR(solid_angle_winding(swept.triangles, {-22.2, 0, 3}), 0, 1e-3);
    Shape shank;
    shank.profile = cone_profile(5, 5, 30);
    const auto before = triangles_of(shank).triangles;
    shank.turns = true;
    EXPECT_EQ(triangles_of(shank).triangles, before);  // it is round already
}

}  // namespace
