// SPDX-License-Identifier: Apache-2.0
// The polyhedron of a turned profile is sound and contains the round body: no point of the body
// lies outside, told by the winding number around it, for profiles with bores, hollows and
// undercuts too.
#include "core/mesh/solid_of_revolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/mesh/mesh_check.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/solid_angle.hpp"

namespace {

using namespace axg;
using axg::test::solid_angle_winding;

using Profile = std::vector<Vec3d>;

constexpr double kTwoPi = 6.283185307179586;

Profile profile_of(std::initializer_list<std::array<double, 2>> points) {
    Profile out;
    for (const auto& p : points) {
        out.push_back({p[0], 0, p[1]});
    }
    return out;
}

/// Is (r, z) inside the profile, by the even-odd rule?
bool is_in_profile(const Profile& p, double r, double z) {
    bool inside = false;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3d a = p[i], b = p[(i + 1) % p.size()];
        if ((a.z > z) != (b.z > z) && r < a.x + (z - a.z) / (b.z - a.z) * (b.x - a.x)) {
            inside = !inside;
        }
    }
    return inside;
}

const Profile kDrill = profile_of({{0, -90}, {4, -86}, {4, -40}, {20, -40}, {20, 0}, {0, 0}});
const Profile kCup = profile_of({{0, -10}, {12, -10}, {12, -40}, {20, -40}, {20, 0}, {0, 0}});

class SolidsOfRevolution : public testing::TestWithParam<int> {};

const Profile& profile_number(int index) {
    static const Profile undercut =
        profile_of({{0, 0}, {30, 0}, {30, 30}, {12, 30}, {18, 12}, {6, 12}, {6, 40}, {0, 40}});
    return index == 0 ? kDrill : index == 1 ? kCup : undercut;
}

TEST_P(SolidsOfRevolution, ContainsTheRoundBodyAndIsSound) {
    const Profile& profile = profile_number(GetParam());
    std::mt19937_64 random(axg::test::printed_seed(11));
    for (const std::uint32_t segments : {8U, 17U, 48U}) {
        const RevolutionResult result = solid_of_revolution(profile, segments);
        ASSERT_EQ(result.status, RevolutionStatus::ok);
        const MeshReport report = check_mesh(result.triangles);
        EXPECT_TRUE(report.is_closed());
        EXPECT_EQ(report.shells, 1U);
        EXPECT_GT(report.volume_mm3, 0);
        EXPECT_EQ(report.degenerate_facets, 0U);
        EXPECT_EQ(report.self_intersections, 0U);
        std::uniform_real_distribution<double> unit(0, 1);
        int inside = 0;
        for (int i = 0; i < 40000 && inside < 3000; ++i) {
            const double r = 31 * unit(random), z = -91 + 132 * unit(random);
            const double angle = kTwoPi * unit(random);
            if (is_in_profile(profile, r, z)) {
                ++inside;
                const Vec3d p{r * std::cos(angle), r * std::sin(angle), z};
                ASSERT_GT(solid_angle_winding(result.triangles, p), 0.5)
                    << r << ' ' << z << ' ' << angle;
            }
        }
        EXPECT_GT(inside, 500);
    }
}

TEST_P(SolidsOfRevolution, StandsOffByNoMoreThanItSays) {
    const Profile& profile = profile_number(GetParam());
    const std::uint32_t segments = 24;
    const RevolutionResult result = solid_of_revolution(profile, segments);
    ASSERT_EQ(result.status, RevolutionStatus::ok);
    const double more = 1 / std::cos(kTwoPi / 2 / segments) - 1 + 2e-6;
    for (const Triangle& t : result.triangles) {
        for (const Vec3f corner : {t.a, t.b, t.c}) {
            const Vec3d p = widen(corner);
            const double r = std::sqrt(p.x * p.x + p.y * p.y);
            bool is_near = false;
            for (const Vec3d& q : profile) {
                is_near = is_near || (p.z == q.z && std::fabs(r - q.x) <= q.x * more);
            }
            EXPECT_TRUE(is_near) << r << ' ' << p.z;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Profiles, SolidsOfRevolution, testing::Values(0, 1, 2));

TEST(SolidOfRevolution, ABoreIsNotFilled) {
    const RevolutionResult result = solid_of_revolution(kCup, 48);
    EXPECT_LT(std::fabs(solid_angle_winding(result.triangles, {0, 0, -30})), 0.5);
    EXPECT_LT(std::fabs(solid_angle_winding(result.triangles, {11.9, 0.3, -30})), 1.5);
    EXPECT_LT(std::fabs(solid_angle_winding(result.triangles, {11.9, 0.0, -30})), 0.5);
}

TEST(SolidOfRevolution, EitherWayRoundGivesTheSameBody) {
    const Profile backwards(kDrill.rbegin(), kDrill.rend());
    EXPECT_EQ(solid_of_revolution(kDrill, 32).triangles,
              solid_of_revolution(backwards, 32).triangles);
}

TEST(SolidOfRevolution, FacetCountsAreTheProfilesOwn) {
    EXPECT_EQ(solid_of_revolution(kDrill, 48).triangles.size(), 48U * 2U * 4U);
}

TEST(SolidOfRevolution, BadProfilesAreRefusedByName) {
    const auto status = [](const Profile& p, std::uint32_t segments = 16) {
        return solid_of_revolution(p, segments).status;
    };
    EXPECT_EQ(status(kDrill, 7), RevolutionStatus::bad_segments);
    EXPECT_EQ(status(kDrill, 8), RevolutionStatus::ok);
    EXPECT_EQ(status(kDrill, 512), RevolutionStatus::ok);
    EXPECT_EQ(status(kDrill, 513), RevolutionStatus::bad_segments);
    EXPECT_EQ(status(profile_of({{0, 0}, {0, 5}})), RevolutionStatus::bad_point_count);
    EXPECT_EQ(status(Profile(513)), RevolutionStatus::bad_point_count);
    EXPECT_EQ(status(profile_of({{0, 0}, {-1, 2}, {0, 5}})), RevolutionStatus::bad_point);
    EXPECT_EQ(status(profile_of({{0, 0}, {1, std::nan("")}, {0, 5}})), RevolutionStatus::bad_point);
    EXPECT_EQ(status(profile_of({{0, 0}, {1.0001e5, 2}, {0, 5}})), RevolutionStatus::bad_point);
    EXPECT_EQ(status(profile_of({{1, 0}, {1, 2}, {0, 5}})), RevolutionStatus::ends_off_axis);
    EXPECT_EQ(status(profile_of({{0, 0}, {2, 2}, {0, 3}, {2, 4}, {0, 5}})),
              RevolutionStatus::touches_axis);
    EXPECT_EQ(status(profile_of({{0, 0}, {2, 2}, {2, 2}, {0, 5}})),
              RevolutionStatus::repeated_point);
    EXPECT_EQ(status(profile_of({{0, 0}, {2, 2}, {0, 0}})), RevolutionStatus::repeated_point);
    EXPECT_EQ(status(profile_of({{0, 0}, {5, 5}, {5, 0}, {1, 5}, {0, 6}})),
              RevolutionStatus::crosses_itself);
    EXPECT_EQ(status(profile_of({{0, 0}, {5, 0}, {3, 0}, {3, 5}, {0, 5}})),
              RevolutionStatus::crosses_itself);
}

TEST(SolidOfRevolution, AGrooveIsKeptWhereThePolygonResolvesItAndRefusedBelow) {
    // A ring groove in the top face, 10 to 10 + width mm from the axis.
    const auto groove = [](double width) {
        return profile_of({{0, 0},
                           {20, 0},
                           {20, 10},
                           {10 + width, 10},
                           {10 + width, 5},
                           {10, 5},
                           {10, 10},
                           {0, 10}});
    };
    // 16 segments: the outer wall of the groove moves in by 1.9 % of its radius.
    EXPECT_EQ(solid_of_revolution(groove(0.25), 16).status, RevolutionStatus::ok);
    EXPECT_EQ(solid_of_revolution(groove(0.15), 16).status, RevolutionStatus::groove_too_narrow);
    EXPECT_EQ(solid_of_revolution(groove(0.15), 48).status, RevolutionStatus::ok);
    const auto v_groove =
        profile_of({{0, 0}, {20, 0}, {20, 10}, {12, 10}, {11, 5}, {10, 10}, {0, 10}});
    EXPECT_EQ(solid_of_revolution(v_groove, 48).status, RevolutionStatus::groove_too_narrow);
}

}  // namespace
